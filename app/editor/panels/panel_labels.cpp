#include <algorithm>
#include <cmath>
#include <set>

#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/text/text.h"
#include "render/label_colours.h"

// The labels of the map, while the case has no structures of them yet.

namespace homolog {

namespace {

constexpr float label_units = 24, label_eye_units = 22, most_labels_listed = 9;

const std::set<int>& hidden_labels_of(const UiContext& ui) {
  static const std::set<int> none;
  const auto& hidden = ui.state.look.hidden_labels;
  return hidden ? *hidden : none;
}

void hide_labels(const std::set<int>& labels, Outbox& out) {
  out.send(HideLabels{std::vector<int>(labels.begin(), labels.end())});
}

/// Those whose name holds what was typed.
std::vector<int> listed_labels(const UiContext& ui) {
  const std::string filter = lower_case(ui.state.look.structures.filter);
  std::vector<int> listed;
  for (const int label : ui.labels().values)
    if (lower_case(ui.labels().label_name(label)).find(filter) != std::string::npos) listed.push_back(label);
  return listed;
}

void draw_label(const UiContext& ui, int label, int in_hand, float width, Outbox& out) {
  const Theme& theme = ui.theme;
  const bool shown = !hidden_labels_of(ui).contains(label);
  const std::string name = ui.labels().label_name(label);
  const Part part(name, "label");
  const ImVec2 at = ImGui::GetCursorScreenPos(), size{width, theme.px(label_units)};
  ImGui::PushID(label);
  const AreaState row = area(theme, name, {width - theme.px(label_eye_units), size.y},
                             name + "\nClick: take this label to fit a template to it", {label == in_hand});
  if (row.clicked) {
    FitSettings settings = ui.state.automatic.fit_settings;
    settings.label = label;
    settings.all_labels = false;
    out.send(SetFit{settings});
  }
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float alpha = (label == in_hand ? 0.25f : 0.0f) + (row.hovered ? 0.08f : 0.0f);
  if (alpha > 0)
    draw.AddRectFilled(at, {at.x + size.x, at.y + size.y}, with_alpha(palette::accent, alpha), theme.px(3));
  const float swatch = theme.px(12), text_y = std::floor(at.y + (size.y - ImGui::GetFontSize()) / 2);
  const Rgb colour = label_colour(label, ui.labels().colours.get());
  colour_swatch(draw, theme, {at.x + theme.px(8), std::floor(at.y + (size.y - swatch) / 2)}, swatch,
                ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], 1}));
  text_at(draw, {at.x + theme.px(28), text_y}, shown ? palette::text : palette::faint,
          shortened(name, width - theme.px(label_eye_units + 34)));
  const float side = theme.px(label_eye_units);
  ImGui::SetCursorScreenPos({at.x + width - side, at.y + std::floor((size.y - side) / 2)});
  if (icon_button(theme, shown ? icon::eye : icon::eye_shut, "eye",
                  shown ? "Hides this label in the slices" : "Shows this label in the slices", {}, false,
                  label_eye_units)) {
    std::set<int> hidden = hidden_labels_of(ui);
    if (shown)
      hidden.insert(label);
    else
      hidden.erase(label);
    hide_labels(hidden, out);
  }
  ImGui::SetCursorScreenPos({at.x, at.y + size.y});
  ImGui::PopID();
}

void draw_label_eyes(const UiContext& ui, const std::vector<int>& listed, int in_hand, Outbox& out) {
  const Theme& theme = ui.theme;
  const float third = (ImGui::GetContentRegionAvail().x - 2 * theme.px(4)) / 3;
  const std::string none_listed = listed.empty() ? "No name holds what you typed." : "";
  if (button(theme, "Show all", "Opens the eyes of all labels in the list", none_listed, third)) {
    std::set<int> hidden = hidden_labels_of(ui);
    for (const int label : listed) hidden.erase(label);
    hide_labels(hidden, out);
  }
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Show none", "Shuts the eyes of all labels in the list", none_listed, third)) {
    std::set<int> hidden = hidden_labels_of(ui);
    hidden.insert(listed.begin(), listed.end());
    hide_labels(hidden, out);
  }
  ImGui::SameLine(0, theme.px(4));
  const auto& values = ui.labels().values;
  const bool none_chosen = std::find(values.begin(), values.end(), in_hand) == values.end();
  if (button(theme, "Only this", "Shows the chosen label and hides the others",
             none_chosen ? "Click a label of the list first." : "", third)) {
    std::set<int> hidden(values.begin(), values.end());
    hidden.erase(in_hand);
    hide_labels(hidden, out);
  }
}

}  // namespace

void draw_labels(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!ui.labels().volume || ui.labels().values.size() < 2) return;
  caption(theme, "Labels of the map");
  std::string filter = ui.state.look.structures.filter;
  if (text_field(theme, "filter", filter, "Filter by name", ImGui::GetContentRegionAvail().x))
    out.send(FilterStructures{filter});
  FitSettings settings = ui.state.automatic.fit_settings;
  settings.all_labels = false;
  const int in_hand =
      label_in_hand(settings, ui.labels().values, *ui.labels().volume, active_shape(ui.state, ui.document()));
  const auto listed = listed_labels(ui);
  const float rows = std::clamp(static_cast<float>(ui.labels().values.size()), 2.0f, most_labels_listed);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  ImGui::BeginChild("labels", {0, std::floor(rows * theme.px(label_units))});
  const float width = ImGui::GetContentRegionAvail().x;
  for (const int label : listed) draw_label(ui, label, in_hand, width, out);
  if (listed.empty()) explanation(theme, "No name holds what you typed.");
  ImGui::EndChild();
  ImGui::PopStyleVar();
  draw_label_eyes(ui, listed, in_hand, out);
}

}  // namespace homolog
