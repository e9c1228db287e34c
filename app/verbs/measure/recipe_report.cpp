#include "app/verbs/measure/recipe_report.h"

#include <algorithm>

#include "core/base/files/files.h"
#include "core/model/files/model_files.h"
#include "core/model/measures/sizes.h"

namespace homolog {

namespace {

Json values_of(const std::vector<MeasuredNumber>& values, const Recipe& recipe) {
  Json by_name = Json::object();
  for (std::size_t k = 0; k < values.size(); ++k)
    by_name[recipe.steps[recipe.measurements[k]].name] = values[k].value ? Json(*values[k].value) : Json();
  return by_name;
}

std::string table_of(const MeasuredByRecipe& measured) {
  const auto& [recipe, cases, modes] = measured;
  const auto any = [&](const auto& has) { return std::ranges::any_of(measured.cases, has); };
  const bool frames = any([](const MeasuredCase& one) { return one.frame.has_value(); });
  const bool groups = any([](const MeasuredCase& one) { return !one.group.empty(); });
  std::string text = "name";
  for (const auto& [there, column] : {std::pair(frames, ",frame"), {groups, ",group"}, {!modes.empty(), ",mode,sd"}})
    if (there) text += column;
  text += measurement_columns(recipe) + '\n';
  for (const MeasuredCase& one : cases) {
    text += csv_field(one.name);
    if (frames) text += ',' + (one.frame ? std::to_string(*one.frame) : "");
    if (groups) text += ',' + csv_field(one.group);
    if (!modes.empty()) text += ",,";
    text += measurement_cells(one.values) + '\n';
  }
  for (const ModeValues& one : modes) {
    text += std::string("model") + (frames ? "," : "") + (groups ? "," : "");
    text += ',' + std::to_string(one.mode) + ',' + std::to_string(static_cast<int>(one.sd));
    text += measurement_cells(one.values) + '\n';
  }
  return text;
}

}  // namespace

Result<Report> report_of_measured(const RecipeJob& job, const MeasuredByRecipe& measured,
                                  std::vector<std::string> warnings) {
  const auto& [recipe, measured_cases, measured_modes] = measured;
  Json measurements = Json::array(), cases = Json::array(), modes = Json::array();
  for (std::size_t k = 0; k < recipe.measurements.size(); ++k) {
    std::vector<std::optional<double>> values;
    for (const MeasuredCase& one : measured_cases) values.push_back(one.values[k].value);
    const Spread spread = spread_of(values);
    const RecipeStep& step = recipe.steps[recipe.measurements[k]];
    Json row{{"name", step.name}, {"unit", step.unit}, {"kind", kind_word(step)}, {"count", spread.count}};
    row["mean"] = spread.count > 0 ? Json(spread.mean) : Json();
    row["sd"] = spread.count > 0 ? Json(spread.sd) : Json();
    measurements.push_back(std::move(row));
  }
  for (const MeasuredCase& one : measured_cases) {
    Json row{{"name", one.name}};
    if (one.frame) row["frame"] = *one.frame;
    if (!one.group.empty()) row["group"] = one.group;
    row["values"] = values_of(one.values, recipe);
    cases.push_back(std::move(row));
  }
  for (const ModeValues& one : measured_modes)
    modes.push_back({{"mode", one.mode}, {"sd", one.sd}, {"values", values_of(one.values, recipe)}});
  Report report;
  report.warnings = std::move(warnings);
  report.values = {{"recipe", recipe.name}, {"measurements", std::move(measurements)}, {"cases", std::move(cases)}};
  if (!job.model.empty()) report.values["modes"] = std::move(modes);
  if (!job.profiles.empty()) report.values["profiles"] = job.profiles.string();
  if (job.out.empty()) return report;
  if (auto written = write_whole_file(job.out, table_of(measured)); !written) return fail(written.error());
  report.values["table"] = job.out.string();
  report.made = {job.out};
  return report;
}

}  // namespace homolog
