#include <algorithm>
#include <array>

#include "app/editor/controls.h"
#include "app/editor/icons.h"
#include "app/editor/ui_context.h"
#include "app/editor/widgets.h"

// Regions and landmarks of the template, in the section Reference.

namespace homolog {

namespace {

/// Colours for new regions, told apart also without colour vision.
constexpr std::array<std::array<std::uint8_t, 3>, 8> region_colours{{{224, 164, 88},
                                                                     {96, 165, 214},
                                                                     {122, 190, 120},
                                                                     {205, 120, 170},
                                                                     {230, 215, 110},
                                                                     {140, 120, 210},
                                                                     {110, 205, 200},
                                                                     {215, 115, 95}}};

/// A row to choose, with its text in the middle of the height of a button; true when it was clicked.
bool chooser(const Theme& theme, const std::string& text, bool chosen, float width, float indent = 0) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float height = theme.px(28);
  const bool clicked = ImGui::Selectable("##row", chosen, 0, {width, height});
  ImGui::GetWindowDrawList()->AddText({at.x + indent + theme.px(4), at.y + (height - ImGui::GetFontSize()) / 2},
                                      palette::text, shortened(text, width - indent - theme.px(8)).c_str());
  return clicked;
}

/// The first colour that no region has yet.
std::array<std::uint8_t, 3> fresh_colour(const Regions& regions) {
  const auto free = std::find_if(region_colours.begin(), region_colours.end(), [&](const auto& colour) {
    return std::none_of(regions.list.begin(), regions.list.end(), [&](const Region& r) { return r.colour == colour; });
  });
  return free != region_colours.end() ? *free : region_colours[regions.list.size() % region_colours.size()];
}

int landmarks_in(const Regions& regions, std::size_t number) {
  return static_cast<int>(std::count(regions.of_vertex.begin(), regions.of_vertex.end(), number));
}

void draw_region(const UiContext& ui, std::size_t index, Outbox& out) {
  const Theme& theme = ui.theme;
  const Regions& regions = *ui.document().regions;
  const Region& region = regions.list[index];
  ImGui::PushID(static_cast<int>(index));
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float height = theme.px(28), swatch = theme.px(12), factor_width = theme.px(72), remove_width = theme.px(24);
  const float name_width = ImGui::GetContentRegionAvail().x - factor_width - remove_width - theme.px(8);
  const bool chosen = ui.state.tool == MouseTool::stiffness && ui.state.brush.region == region.name;
  if (chooser(theme, region.name, chosen, name_width, theme.px(20)))
    out.change([name = region.name](EditorState& s) {
      s.tool = MouseTool::stiffness;
      s.brush.region = name;
      if (s.brush.paints != BrushPaints::fill) s.brush.paints = BrushPaints::region;
    });
  if (ImGui::IsItemHovered())
    tooltip(theme, format("%d landmarks; a click takes the brush that paints them", landmarks_in(regions, index + 1)));
  const float y = at.y + (height - swatch) / 2;
  ImGui::GetWindowDrawList()->AddRectFilled({at.x + theme.px(4), y}, {at.x + theme.px(4) + swatch, y + swatch},
                                            IM_COL32(region.colour[0], region.colour[1], region.colour[2], 255),
                                            theme.px(2));
  ImGui::SameLine(0, theme.px(4));
  CaseNumber factor(ui, "factor of " + region.name, region.factor);
  bool released = false;
  const bool changed = number_field(theme, "factor", factor.value, 0.05, "%.1f", "\xc3\x97", factor_width,
                                    "Stiffness of the region relative to the base", released);
  factor.value = std::clamp(factor.value, 0.01, 1000.0);
  factor.settle(
      changed, released,
      [&](double value) {
        return SetRegion{{region.name, value, region.colour}};
      },
      out);
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "\xc3\x97", "Forgets the region; its landmarks keep their stiffness", {}, remove_width))
    out.apply(RemoveRegion{region.name});
  ImGui::PopID();
}

}  // namespace

void draw_regions(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Regions& regions = *ui.document().regions;
  caption(theme, "Regions");
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {theme.px(4), theme.px(2)});
  for (std::size_t r = 0; r < regions.list.size(); ++r) draw_region(ui, r, out);
  ImGui::PopStyleVar();
  std::string name = ui.state.new_region;
  const float width = ImGui::GetContentRegionAvail().x, add_width = theme.px(64);
  if (text_field(theme, "##new region", name, "New region, e.g. hilum", width - add_width - theme.px(4)))
    out.change([name](EditorState& s) { s.new_region = name; });
  const bool entered = enter_pressed();
  const bool taken =
      std::any_of(regions.list.begin(), regions.list.end(), [&](const Region& r) { return r.name == name; });
  ImGui::SameLine(0, theme.px(4));
  const bool add = button(theme, "Add", "Adds the region and takes the brush that paints it (Enter)",
                          name.empty() ? "Type a name first."
                          : taken      ? "There is a region of that name."
                                       : "",
                          add_width);
  if (add || (entered && !name.empty() && !taken)) {
    out.apply(SetRegion{{name, 1, fresh_colour(regions)}});
    out.change([name](EditorState& s) {
      s.new_region.clear();
      s.tool = MouseTool::stiffness;
      s.brush.region = name;
      s.brush.paints = BrushPaints::region;
    });
  }
  if (button(theme, "Stiffness from a mesh…", "A PLY with one value per vertex, of the same vertices", {}, width))
    out.change([](EditorState& s) { show_file_dialog(s, FilePurpose::open_stiffness); });
}

void draw_template_landmarks(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& landmarks = ui.document().reference->landmarks;
  caption(theme, format("Landmarks of the template: %zu", landmarks.size()).c_str());
  const bool naming = ui.state.tool == MouseTool::template_landmark;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {theme.px(4), theme.px(2)});
  for (const Landmark& landmark : landmarks) {
    ImGui::PushID(landmark.name.c_str());
    const float remove_width = theme.px(24);
    const float name_width = ImGui::GetContentRegionAvail().x - remove_width - theme.px(4);
    if (chooser(theme, landmark.name, naming && ui.state.template_landmark == landmark.name, name_width))
      out.change([name = landmark.name](EditorState& s) {
        s.tool = MouseTool::template_landmark;
        s.template_landmark = name;
      });
    if (ImGui::IsItemHovered()) tooltip(theme, "A click on it, then on the mesh, moves it");
    ImGui::SameLine(0, theme.px(4));
    if (button(theme, "\xc3\x97", "Takes the landmark off the template", {}, remove_width))
      out.apply(SetTemplateLandmark{landmark.name, std::nullopt});
    ImGui::PopID();
  }
  ImGui::PopStyleVar();
  std::string name = ui.state.template_landmark;
  const float width = ImGui::GetContentRegionAvail().x, add_width = theme.px(64);
  if (text_field(theme, "##new landmark", name, "New landmark, e.g. apex", width - add_width - theme.px(4)))
    out.change([name](EditorState& s) { s.template_landmark = name; });
  const bool entered = enter_pressed() && !name.empty();
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, naming ? "Click…" : "Name", "Then click the point on the mesh, in any view (Enter)",
             name.empty() ? "Type a name first." : "", add_width) ||
      entered)
    out.change([](EditorState& s) { s.tool = MouseTool::template_landmark; });
  const float half = (width - theme.px(4)) / 2;
  if (button(theme, "Import…##template", "3D Slicer (.mrk.json) or scalismo (.json), in the template's own frame", {},
             half))
    out.change([](EditorState& s) { show_file_dialog(s, FilePurpose::open_template_landmarks); });
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Export…##template", "3D Slicer (.mrk.json) or scalismo (.json), in the template's own frame",
             landmarks.empty() ? "There is none yet." : "", half))
    out.change(
        [](EditorState& s) { show_file_dialog(s, FilePurpose::export_template_landmarks, "landmarks.mrk.json"); });
}

}  // namespace homolog
