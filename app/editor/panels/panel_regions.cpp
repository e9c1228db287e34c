#include <algorithm>
#include <array>
#include <span>

#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"

// Regions and landmarks of the template, in the section Template.

namespace homolog {

namespace {

/// Colours for new regions, told apart also without colour vision.
constexpr std::array<std::array<std::uint8_t, 3>, 8> region_colours{{{224, 164, 88},
                                                                     {96, 165, 214},
                                                                     {158, 98, 74},
                                                                     {178, 34, 128},
                                                                     {224, 215, 66},
                                                                     {142, 75, 233},
                                                                     {147, 187, 140},
                                                                     {208, 57, 22}}};

using Colour = std::array<std::uint8_t, 3>;

/// The first colour from the `first`-th on that no region has yet; that one where all are taken.
Colour free_colour(const Regions& regions, std::size_t first) {
  for (std::size_t k = 0; k < region_colours.size(); ++k) {
    const Colour& colour = region_colours[(first + k) % region_colours.size()];
    if (std::none_of(regions.list.begin(), regions.list.end(), [&](const Region& r) { return r.colour == colour; }))
      return colour;
  }
  return region_colours[first % region_colours.size()];
}

/// For a new region, and for one whose colour is to change.
Colour fresh_colour(const Regions& regions) {
  return free_colour(regions, regions.list.size() < region_colours.size() ? 0 : regions.list.size());
}
Colour next_colour(const Regions& regions, const Colour& colour) {
  const auto at = std::find(region_colours.begin(), region_colours.end(), colour);
  return free_colour(regions,
                     at == region_colours.end() ? 0 : static_cast<std::size_t>(at - region_colours.begin()) + 1);
}

void take_region_brush(const std::string& name, Outbox& out) {
  out.send(BrushRegion{name});
}

int landmarks_in(const Regions& regions, std::size_t number) {
  return static_cast<int>(std::count(regions.of_vertex.begin(), regions.of_vertex.end(), number));
}

/// In place of the row: the name as it is typed. Enter takes it, Escape does not.
void draw_renaming(const UiContext& ui, const Regions& regions, float width, Outbox& out) {
  RenameRegion renaming = ui.state.hand.renaming->rename;
  if (!ui.state.hand.renaming->focused) {
    ImGui::SetKeyboardFocusHere();
    out.send(NameRegion{RegionNaming{renaming, true}});
  }
  if (text_field(ui.theme, "new name", renaming.to, "Name", width)) out.send(NameRegion{RegionNaming{renaming, true}});
  const bool entered = enter_pressed(), left = ImGui::IsItemDeactivated();
  if (!entered && !left) return;
  const bool taken = std::any_of(regions.list.begin(), regions.list.end(),
                                 [&](const Region& region) { return region.name == renaming.to; });
  const bool take = entered && !renaming.to.empty() && !taken;
  if (take) out.apply(renaming);
  if (take && ui.state.hand.brush.region == renaming.name) {
    BrushSettings brush = ui.state.hand.brush;
    brush.region = renaming.to;
    out.send(SetBrush{brush});
  }
  out.send(NameRegion{});
}

/// The colour and the name: a click on the one gives another, on the other takes the brush; a double click renames.
void draw_region_name(const UiContext& ui, std::size_t index, float width, Outbox& out) {
  const Theme& theme = ui.theme;
  const Regions& regions = *ui.structure()->paint.regions;
  const Region& region = regions.list[index];
  if (ui.state.hand.renaming && ui.state.hand.renaming->rename.name == region.name)
    return draw_renaming(ui, regions, width, out);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float side = theme.px(12), indent = theme.px(20), y = at.y + (theme.px(28) - side) / 2;
  const bool chosen = ui.state.hand.tool == MouseTool::stiffness && ui.state.hand.brush.region == region.name;
  const bool on_swatch = ImGui::GetMousePos().x < at.x + indent;
  std::vector<std::string> names;
  for (const Region& one : regions.list) names.push_back(one.name);
  const auto row = list_row(theme, region.name, chosen, {width, theme.px(28)},
                            on_swatch ? std::string("Click for another colour")
                                      : format("%d vertices. Click to paint the region, double-click to rename it",
                                               landmarks_in(regions, index + 1)),
                            indent, names);
  if (row.clicked && on_swatch) out.apply(SetRegion{{region.name, region.factor, next_colour(regions, region.colour)}});
  if (row.clicked && !on_swatch) take_region_brush(region.name, out);
  if (row.doubled && !on_swatch) out.send(NameRegion{RegionNaming{{region.name, region.name}}});
  colour_swatch(*ImGui::GetWindowDrawList(), theme, {at.x + theme.px(4), y}, side,
                IM_COL32(region.colour[0], region.colour[1], region.colour[2], 255));
}

/// The factor that the case holds: the shown document may be a preview of the very change that is compared with it.
double committed_factor(const UiContext& ui, const Region& region) {
  if (const Structure* structure = active_structure(ui.state, *ui.snapshot().document))
    for (const Region& kept : structure->paint.regions->list)
      if (kept.name == region.name) return kept.factor;
  return region.factor;
}

void draw_region(const UiContext& ui, std::size_t index, Outbox& out) {
  const Theme& theme = ui.theme;
  const Region& region = ui.structure()->paint.regions->list[index];
  const Part part(region.name, "region");
  const float factor_width = theme.px(72), remove_width = theme.px(24);
  draw_region_name(ui, index, ImGui::GetContentRegionAvail().x - factor_width - remove_width - theme.px(8), out);
  ImGui::SameLine(0, theme.px(4));
  CaseNumber factor(ui, "factor of " + region.name, committed_factor(ui, region));
  bool released = false;
  const bool changed =
      number_field(theme, "factor", factor.value, released,
                   {.per_px = 0.05,
                    .unit = "\xc3\x97",
                    .width_px = factor_width,
                    .tip = "Stiffness factor of the region: below 1 it is softer than the base, above 1 stiffer",
                    .height_units = 28,
                    .limits = {.low = 0.01, .high = 1000, .name = "The factor of " + region.name}});
  factor.settle(
      changed, released,
      [&](double value) {
        return SetRegion{{region.name, value, region.colour}};
      },
      out);
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "\xc3\x97", "Removes the region. Its vertices keep their stiffness", {}, remove_width))
    out.apply(RemoveRegion{region.name});
}

}  // namespace

void draw_regions(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Regions& regions = *ui.structure()->paint.regions;
  caption(theme, "Regions");
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {theme.px(4), theme.px(2)});
  for (std::size_t r = 0; r < regions.list.size(); ++r) draw_region(ui, r, out);
  ImGui::PopStyleVar();
  std::string name = ui.state.hand.new_region;
  const float width = ImGui::GetContentRegionAvail().x, add_width = theme.px(64);
  if (text_field(theme, "new region", name, "New region, e.g. hilum", width - add_width - theme.px(4)))
    out.send(TypeRegion{name});
  const bool entered = enter_pressed();
  const bool taken =
      std::any_of(regions.list.begin(), regions.list.end(), [&](const Region& r) { return r.name == name; });
  ImGui::SameLine(0, theme.px(4));
  const bool add = button(theme, "Add", "Adds the region and takes its brush (Enter)",
                          name.empty() ? "Type a name first."
                          : taken      ? "There is a region with this name already."
                                       : "",
                          add_width);
  if (add || (entered && !name.empty() && !taken)) {
    out.apply(SetRegion{{name, 1, fresh_colour(regions)}});
    out.send(TypeRegion{});
    BrushSettings brush = ui.state.hand.brush;
    brush.paints = BrushPaints::region;
    out.send(SetBrush{brush});
    out.send(BrushRegion{name});
  }
  if (button(theme, "Stiffness from a mesh…",
             "Takes the stiffness factors, one for each vertex, from a PLY with the same vertices", {}, width))
    out.send(ShowFileDialog{FilePurpose::open_stiffness, {}});
}

void draw_template_landmarks(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& landmarks = ui.structure()->the_template->landmarks;
  caption(theme, format("Landmarks of the template: %zu", landmarks.size()).c_str());
  const bool naming = ui.state.hand.tool == MouseTool::template_landmark;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {theme.px(4), theme.px(2)});
  // The section Place lists them all the same while none is being named.
  const float whole = ImGui::GetContentRegionAvail().x;
  if (!naming && !landmarks.empty() &&
      button(theme, "Move or remove landmarks…", "Lists them here, and takes the tool that names points of the mesh",
             {}, whole)) {
    out.send(NameTemplateLandmark{});
    out.send(ChooseTool{MouseTool::template_landmark});
  }
  if (naming && button(theme, "Done with landmarks", "Takes up the tool that you had before", {}, whole)) {
    out.send(NameTemplateLandmark{});
    out.send(ChooseTool{ui.state.hand.tool_before_naming});
  }
  std::vector<std::string> names;
  for (const Landmark& landmark : landmarks) names.push_back(landmark.name);
  for (const Landmark& landmark : naming ? std::span(landmarks) : std::span<const Landmark>()) {
    const Part part(landmark.name, "landmark of the template");
    const float remove_width = theme.px(24);
    const float name_width = ImGui::GetContentRegionAvail().x - remove_width - theme.px(4);
    if (list_row(theme, landmark.name, naming && ui.state.hand.template_landmark == landmark.name,
                 {name_width, theme.px(28)}, "To move it, click here, then on the mesh", 0, names)
            .clicked) {
      out.send(NameTemplateLandmark{landmark.name});
      out.send(ChooseTool{MouseTool::template_landmark});
    }
    ImGui::SameLine(0, theme.px(4));
    if (button(theme, "\xc3\x97", "Removes the landmark from the template", {}, remove_width))
      out.apply(SetTemplateLandmark{landmark.name, std::nullopt});
  }
  ImGui::PopStyleVar();
  std::string name = ui.state.hand.template_landmark;
  const float width = ImGui::GetContentRegionAvail().x, add_width = theme.px(64);
  if (text_field(theme, "new landmark", name, "New landmark, e.g. apex", width - add_width - theme.px(4)))
    out.send(NameTemplateLandmark{name});
  const bool entered = enter_pressed() && !name.empty();
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, naming ? "Click…" : "Name",
             "Click here (or press Enter), then click the point on the mesh in any view",
             name.empty() ? "Type a name first." : "", add_width) ||
      entered)
    out.send(ChooseTool{MouseTool::template_landmark});
  const float half = (width - theme.px(4)) / 2;
  if (button(theme, "Import…##template", "3D Slicer (.mrk.json) or scalismo (.json), in the template's own coordinates",
             {}, half))
    out.send(ShowFileDialog{FilePurpose::open_template_landmarks, {}});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Export…##template", "3D Slicer (.mrk.json) or scalismo (.json), in the template's own coordinates",
             landmarks.empty() ? "There is no landmark yet." : "", half))
    out.send(ShowFileDialog{FilePurpose::export_template_landmarks, "landmarks.mrk.json"});
}

}  // namespace homolog
