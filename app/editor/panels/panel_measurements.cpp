#include <algorithm>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/widgets/widgets.h"
#include "core/catalogue/catalogue.h"

// What a recipe measures of the shown mesh.

namespace homolog {

namespace {

/// The recipes that ship, and the file that was chosen.
void draw_recipe_choice(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const std::string& source = ui.state.measurements.source;
  const std::vector<std::string> shipped = shipped_recipes();
  std::vector<std::string> options = shipped;
  if (!source.empty() && std::ranges::find(shipped, source) == shipped.end())
    options.push_back(std::filesystem::path(source).filename().string());
  int chosen = source.empty() ? -1 : static_cast<int>(std::ranges::find(shipped, source) - shipped.begin());
  if (combo(theme, "recipe", options, chosen) && chosen < static_cast<int>(shipped.size()))
    out.send(ChooseRecipe{shipped[chosen]});
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  if (button(theme, "Recipe\xe2\x80\xa6",
             "Opens a file that says what to measure: NAME.recipe.json. One beside the template, of its name, is taken "
             "by itself",
             {}, half))
    out.send(ShowFileDialog{FilePurpose::open_recipe, {}});
  ImGui::SameLine(0, theme.px(4));
  const std::string refusal = ui.state.measurements.recipe == nullptr ? "Choose a recipe first." : ui.needs_shape();
  if (button(theme, "Table\xe2\x80\xa6", "All measurements as a table of one row, as homolog measure writes it: .csv",
             refusal, half))
    out.send(ShowFileDialog{FilePurpose::export_measurements,
                            case_name(ui.snapshot().file, *ui.snapshot().document) + "-measurements.csv"});
}

/// Why there is no value, as a sentence.
std::string why_missing(const std::string& reason) {
  return (reason.starts_with('"') ? "" : "The mesh ") + reason + ".";
}

void draw_measurement(const UiContext& ui, const RecipeStep& step, const MeasuredNumber& number, bool has_lines,
                      Outbox& out) {
  const Theme& theme = ui.theme;
  constexpr float eye_units = 20;
  const Part part(step.name, "measurement");
  const bool drawn = ui.state.measurements.drawn.contains(step.name);
  const std::string refusal = !number.value ? why_missing(number.missing)
                              : !has_lines  ? "It is of a whole surface, which has no lines to draw."
                                            : "";
  if (icon_button(theme, drawn ? icon::eye : icon::eye_shut, "eye",
                  drawn ? "Hides its lines in the 3D view" : "Draws it on the mesh in the 3D view",
                  drawn ? std::string() : refusal, false, eye_units))
    out.send(DrawMeasurement{step.name, !drawn});
  ImGui::SameLine(0, theme.px(4));
  if (number.value)
    figure(theme, step.name.c_str(), value_with_unit(*number.value, step.unit), step.name + ": " + kind_word(step));
  else
    figure(theme, step.name.c_str(), "\xe2\x80\x93", why_missing(number.missing), palette::faint);
}

}  // namespace

std::string recipe_in_words(const UiContext& ui) {
  const auto& recipe = ui.state.measurements.recipe;
  return recipe != nullptr && ui.has_shape() ? format("%zu, ", recipe->measurements.size()) + recipe->name
                                             : std::string();
}

void draw_measurements_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& recipe = ui.state.measurements.recipe;
  draw_recipe_choice(ui, out);
  if (recipe == nullptr)
    return explanation(theme, "A recipe says what to measure: distances, angles, girths, volumes. Choose one.");
  if (!ui.has_shape()) return explanation(theme, ui.needs_shape());
  const auto& measured = ui.work.measurements.latest();
  const std::string& error = ui.work.measurements.error();
  if (!measured || measured->recipe != recipe)
    return explanation(theme, error.empty() ? "Measuring\xe2\x80\xa6" : error);
  for (std::size_t k = 0; k < recipe->measurements.size(); ++k)
    draw_measurement(ui, recipe->steps[recipe->measurements[k]], measured->numbers[k],
                     !measured->lines[k].lines.empty(), out);
}

}  // namespace homolog
