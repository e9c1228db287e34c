#include "app/verbs/report/report_measurements.h"

#include <algorithm>
#include <map>

#include "app/verbs/report/report_methods.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/recipe/recipe.h"
#include "core/model/shapes/shape_files.h"

namespace homolog {

namespace {

constexpr int page_measured_modes = 3, page_most_sd = 3;
constexpr int page_steps = 2 * page_most_sd + 1;  ///< of a mode

/// A model has no landmarks: those of the template, or of the first shape, are carried along its modes.
Result<Lenders> lenders_of_page(const ReportVerb& verb, PageContent& content) {
  Lenders lenders;
  if (!verb.the_template.empty()) {
    auto lender = load_template(verb.the_template);
    if (!lender) return fail(lender.error());
    lenders.add(std::move(*lender));
    auto mean = measured_shape(content.model, points_of(content.model.mean));
    if (!mean) return fail(mean.error());
    if (!lenders.lend_to(*mean)) content.warnings.push_back(unsuited_template(verb.the_template, "the model"));
  }
  if (content.from_model || !content.model.parts.empty()) return lenders;
  const auto sources = shape_sources(verb.training.files, verb.training.reading.group);
  if (!sources) return fail(sources.error());
  for (const ShapeSource& source : *sources) {
    const auto mesh = read_shape(source);
    if (!mesh) continue;  // the model has said so
    std::shared_ptr<const Topology> faces;
    auto structure = measured_structure({}, **mesh, faces);
    if (!structure) return fail(source.file.string(), structure.error().what);
    lenders.add(MeasuredShape{{std::move(*structure)}});
    break;
  }
  return lenders;
}

/// A sentence for each reason for which the mean lacks measurements.
std::vector<std::string> missing_on_page(const Recipe& recipe, const ModeValues& mean) {
  std::map<std::string, std::vector<std::string>> reasons;
  for (std::size_t k = 0; k < mean.values.size(); ++k) {
    const RecipeStep& step = recipe.steps[recipe.measurements[k]];
    if (!mean.values[k].value && !step.optional) reasons[mean.values[k].missing].push_back(step.name);
  }
  std::vector<std::string> sentences;
  for (const auto& [reason, names] : reasons)
    sentences.push_back("the model: " + reason + ", so " + listed(names, " and ") +
                        (names.size() == 1 ? " is" : " are") + " left empty");
  return sentences;
}

std::string page_value_text(const MeasuredNumber& number, const std::string& unit) {
  return number.value ? value_with_unit(*number.value, unit) : "\xe2\x80\x93";
}

}  // namespace

Result<void> measure_page(const ReportVerb& verb, PageContent& content, Progress& progress) {
  if (verb.recipe.empty())
    return fail(verb.the_template,
                "has no recipe beside it; give one with --recipe (" + listed(shipped_recipes(), ", ") + " or a file)");
  auto recipe = load_recipe(verb.recipe);
  if (!recipe) return fail(recipe.error());
  const auto lenders = lenders_of_page(verb, content);
  if (!lenders) return fail(lenders.error());
  const int modes = static_cast<int>(std::min<Eigen::Index>(page_measured_modes, content.model.modes()));
  auto along = measure_modes(*recipe, content.model, modes, *lenders, progress, page_most_sd);
  if (!along) return fail(along.error());
  content.along_modes = std::move(*along);
  const auto missing = missing_on_page(*recipe, content.along_modes[page_most_sd]);
  content.warnings.insert(content.warnings.end(), missing.begin(), missing.end());
  content.recipe = std::make_shared<const Recipe>(std::move(*recipe));
  return {};
}

Json measurements_json(const PageContent& content) {
  Json measurements = Json::array();
  for (std::size_t k = 0; content.recipe && k < content.recipe->measurements.size(); ++k) {
    const RecipeStep& step = content.recipe->steps[content.recipe->measurements[k]];
    Json values = Json::array(), texts = Json::array();
    for (std::size_t at = 0; at < content.along_modes.size(); at += page_steps) {
      Json of_mode = Json::array(), said = Json::array();
      for (std::size_t one = at; one < at + page_steps; ++one) {
        const MeasuredNumber& number = content.along_modes[one].values[k];
        of_mode.push_back(number.value ? Json(*number.value) : Json());
        said.push_back(page_value_text(number, step.unit));
      }
      values.push_back(std::move(of_mode));
      texts.push_back(std::move(said));
    }
    measurements.push_back(
        {{"name", step.name}, {"unit", step.unit}, {"values", std::move(values)}, {"texts", std::move(texts)}});
  }
  return measurements;
}

std::string measurements_html(const PageContent& content) {
  if (!content.recipe) return {};
  std::string html =
      "<section aria-labelledby=\"measurements-title\">\n<h2 id=\"measurements-title\">Measurements</h2>\n"
      "<div class=\"plots needs-script\" id=\"measurements\"></div>\n<div class=\"table\"><table>\n<thead><tr><th "
      "scope=\"col\">Measurement</th><th scope=\"col\">Mode</th>";
  for (int sd = -page_most_sd; sd <= page_most_sd; ++sd)
    html += "<th scope=\"col\">" +
            (sd == 0 ? std::string("Mean") : (sd < 0 ? "\xe2\x88\x92" : "+") + std::to_string(std::abs(sd)) + " SD") +
            "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const Json& one : measurements_json(content))
    for (std::size_t mode = 0; mode < one["texts"].size(); ++mode) {
      html += "<tr><th scope=\"row\">" + (mode == 0 ? html_text(one["name"].get<std::string>()) : std::string()) +
              "</th><td>" + std::to_string(mode + 1) + "</td>";
      for (const Json& text : one["texts"][mode]) html += "<td>" + html_text(text.get<std::string>()) + "</td>";
      html += "</tr>\n";
    }
  html +=
      "</tbody></table></div>\n<p class=\"tip below\">Each is measured on the shapes that the model makes, by the "
      "recipe " +
      html_text(content.recipe->name) + ".";
  if (content.model.alignment == Alignment::similarity)
    html +=
        " The shapes were brought to the mean size, so lengths, areas and volumes are those of an organ of that size.";
  return html + "</p>\n</section>\n";
}

}  // namespace homolog
