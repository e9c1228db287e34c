#include <imgui.h>
// After imgui.h, which it does not include.
#include <imgui_stdlib.h>

#include <cmath>
#include <cstdint>

#include "app/editor/scene/case_thumbnails.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/icons.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/window/models_ui.h"

namespace homolog {

namespace {

// Layout units.
constexpr float group_title_width = 66, state_width = 28, distance_width = 52, row_height = 40;

const char* state_icon(CaseState state) {
  switch (state) {
    case CaseState::to_do:
      return icon::outline;
    case CaseState::in_work:
      return icon::half_done;
    case CaseState::done:
      return icon::check;
  }
  return "";
}

ImU32 state_colour(CaseState state) {
  return state == CaseState::done ? palette::good : state == CaseState::in_work ? palette::amber : palette::faint;
}

void draw_study_menu(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme.px(8), theme.px(8)});
  if (ImGui::BeginPopup("study menu")) {
    const auto item = [&](const char* label, const char* keys, auto act) {
      if (ImGui::MenuItem(label, keys)) act();
    };
    const auto ask = [&](FilePurpose purpose, std::string name = {}) {
      out.change([purpose, name](EditorState& s) { show_file_dialog(s, purpose, name); });
    };
    item("New study\xe2\x80\xa6", nullptr, [&] { ask(FilePurpose::new_study, "study.study.json"); });
    item("Open study\xe2\x80\xa6", "Ctrl+O", [&] { ask(FilePurpose::open_study); });
    if (!ui.state.models.study_file.empty())
      item("Save study as\xe2\x80\xa6", "Ctrl+S",
           [&] { ask(FilePurpose::save_study, ui.state.models.study_file.filename().string()); });
    const ModelsState& state = ui.state.models;
    if (!state.study_file.empty()) {
      item("Set the template\xe2\x80\xa6", nullptr, [&] { ask(FilePurpose::open_study_template); });
      if (ImGui::IsItemHovered())
        tooltip(theme, "A mesh of the shapes' numbering: gives .particles their faces" +
                           (state.study.template_file.empty() ? "" : ". Now " + state.study.template_file.string()));
    }
    if (!state.shapes.empty()) {
      ImGui::Separator();
      const auto export_as = [&](const char* extension) {
        out.change([extension](EditorState& s) { s.models.export_extension = extension; });
        ask(FilePurpose::export_shapes, study_stem(state) + "-shapes");
      };
      item("Export shapes as imported\xe2\x80\xa6", nullptr, [&] { export_as(""); });
      item("Export shapes as .ply\xe2\x80\xa6", nullptr, [&] { export_as(".ply"); });
      item("Export shapes as .particles\xe2\x80\xa6", nullptr, [&] { export_as(".particles"); });
    }
    ImGui::Separator();
    item("Phantom vertebrae (10 subjects)", nullptr, [&] { out.send(OpenPhantomStudy{Organ::vertebra}); });
    item("Phantom kidneys (16 subjects)", nullptr, [&] { out.send(OpenPhantomStudy{Organ::kidney}); });
    item("Phantom ventricle (20 phases)", nullptr, [&] { out.send(OpenPhantomStudy{Organ::ventricle}); });
    ImGui::EndPopup();
  }
  ImGui::PopStyleVar();
}

void draw_buttons(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const float next = theme.px(28), width = (ImGui::GetContentRegionAvail().x - next - 2 * theme.px(8)) / 2;
  if (button(theme, std::string("Study  ") + icon::down_angle, "New, open, save as, phantoms", {}, width))
    ImGui::OpenPopup("study menu");
  const ImVec2 below{ImGui::GetItemRectMin().x, ImGui::GetItemRectMax().y + theme.px(4)};
  ImGui::SetNextWindowPos(below);
  draw_study_menu(ui, out);
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, std::string(icon::plus) + "  Meshes\xe2\x80\xa6",
             "Add meshes (PLY, VTK, VTP, OBJ), .particles or cases of this editor; or drop them on the window", {},
             width))
    out.change([](EditorState& s) { show_file_dialog(s, FilePurpose::add_shapes); });
  ImGui::SameLine(0, theme.px(8));
  if (icon_button(theme, icon::next, "next", "Next case that is not done (N)",
                  state.study.next_case() < 0 ? "Every case is done." : "", false, 28))
    out.change([](EditorState& s) { select_next_case(s.models); });
}

/// A title of the list that sorts it.
void draw_title(const UiContext& ui, const char* text, CaseColumn column, float x_px, float width_px, bool at_right,
                const char* tip, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  ImGui::SetCursorPosX(x_px);
  const ImVec2 at = ImGui::GetCursorScreenPos(), size{width_px, theme.px(20)};
  if (ImGui::InvisibleButton(text, size)) out.change([column](EditorState& s) { sort_by(s.models, column); });
  const bool sorted = state.sorted_by == column;
  const ImU32 colour = ImGui::IsItemHovered() ? palette::accent : sorted ? palette::text : palette::dim;
  if (ImGui::IsItemHovered()) tooltip(theme, tip);
  const std::string label =
      std::string(text) + (sorted ? std::string(" ") + (state.descending ? icon::down_angle : icon::arrow_up) : "");
  ImGui::PushFont(theme.small);
  const float width = ImGui::CalcTextSize(label.c_str()).x;
  ImGui::GetWindowDrawList()->AddText({at_right ? at.x + size.x - width : at.x, at.y + theme.px(2)}, colour,
                                      label.c_str());
  ImGui::PopFont();
  ImGui::SameLine(0, 0);
}

struct Columns {
  float picture, name, group, state, distance, right;
};
Columns columns_in(const Theme& theme, float width_px) {
  Columns c{};
  c.right = width_px - theme.px(8);
  c.distance = c.right - theme.px(distance_width);
  c.state = c.distance - theme.px(state_width);
  c.group = c.state - theme.px(group_title_width);
  c.picture = theme.px(2);
  c.name = c.picture + theme.px(CaseThumbnails::width + 6);
  return c;
}

ImU32 distance_colour(const StudyModel& model, std::ptrdiff_t shape) {
  for (const DoubtfulShape& one : model.doubtful_shapes)
    if (one.shape == shape) return one.doubt == Doubt::far_outside ? palette::bad : palette::amber;
  return palette::dim;
}

void draw_row(const UiContext& ui, const StudyCase& one, float width_px, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  ImGui::PushID(one.name.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{width_px, theme.px(row_height)};
  const Columns columns = columns_in(theme, size.x);
  ImGui::SetItemAllowOverlap();
  const bool clicked = ImGui::InvisibleButton("row", size);
  ImGui::SetItemAllowOverlap();
  const bool hovered = ImGui::IsItemHovered();
  if (clicked) out.change([name = one.name](EditorState& s) { s.models.selected = name; });
  if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) out.send(OpenCaseOfStudy{one.name, {}});
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const bool selected = state.selected == one.name;
  if (selected || hovered)
    draw.AddRectFilled(at, {at.x + size.x, at.y + size.y},
                       selected ? with_alpha(palette::accent, 0.25f) : palette::raised, theme.px(4));
  const float y = at.y + std::floor((size.y - ImGui::GetFontSize()) / 2);
  const auto shape = state.model ? state.model->index_of(one.name) : -1;
  if (const unsigned texture = ui.thumbnails.texture(one.name)) {
    const ImVec2 corner{std::floor(at.x + columns.picture),
                        std::floor(at.y + (size.y - theme.px(CaseThumbnails::height)) / 2)};
    draw.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(texture)), corner,
                  {corner.x + theme.px(CaseThumbnails::width), corner.y + theme.px(CaseThumbnails::height)});
  }
  const float name_room = columns.state - columns.name - theme.px(8) - (one.notes.empty() ? 0 : theme.px(20));
  const std::string name = shortened(one.name, name_room);
  const bool left_out = state.model && shape < 0;
  const float name_y = one.group.empty() ? y : std::floor(at.y + theme.px(3));
  draw.AddText({at.x + columns.name, name_y}, left_out ? palette::bad : palette::text, name.c_str());
  if (!one.notes.empty())
    draw.AddText({at.x + columns.name + ImGui::CalcTextSize(name.c_str()).x + theme.px(6), name_y}, palette::dim,
                 icon::note);
  if (!one.group.empty()) {
    ImGui::PushFont(theme.small);
    draw.AddText({at.x + columns.name, std::floor(at.y + theme.px(21))}, palette::dim,
                 shortened(one.group, columns.state - columns.name - theme.px(8)).c_str());
    ImGui::PopFont();
  }
  if (const auto distance = distance_mm(state, one)) {
    const std::string text = format("%.2f", *distance);
    draw.AddText({at.x + columns.right - ImGui::CalcTextSize(text.c_str()).x, y}, distance_colour(*state.model, shape),
                 text.c_str());
  }
  if (hovered) {
    std::string tip = one.file.string();
    if (left_out) tip += "\nNot in the model.";
    if (!one.notes.empty()) tip += "\n" + one.notes;
    tip += is_case_file(one.file) ? "\nDouble-click opens it." : "\nDouble-click opens it for repair.";
    tooltip(theme, tip);
  }
  ImGui::SetCursorScreenPos({at.x + columns.state, at.y});
  if (ImGui::InvisibleButton("state", {theme.px(24), size.y}))
    out.change([name = one.name](EditorState& s) { cycle_case_state(s.models, name); });
  if (ImGui::IsItemHovered()) tooltip(theme, std::string("State: ") + state_name(one.state) + ". Click for the next.");
  draw.AddText({at.x + columns.state + theme.px(4), y}, state_colour(one.state), state_icon(one.state));
  ImGui::PopID();
}

/// Says which shapes are mirror images, with the offer to flip them.
void draw_mirrored(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& mirrored = ui.state.models.mirrored;
  if (mirrored.empty()) return;
  std::string names;
  for (const std::string& name : mirrored) names += (names.empty() ? "" : ", ") + name;
  ImGui::PushStyleColor(ImGuiCol_Text, palette::amber);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted((mirrored.size() == 1
                              ? names + " is a mirror image of the other shapes."
                              : format("%zu shapes are mirror images of the others: ", mirrored.size()) +
                                    shortened(names, 3 * ImGui::GetContentRegionAvail().x) + ".")
                             .c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
  if (button(theme, mirrored.size() == 1 ? "Flip it left for right" : "Flip them left for right",
             "In this study alone; the files stay as they are", {}, ImGui::GetContentRegionAvail().x))
    out.change([mirrored](EditorState& s) { flip_cases(s.models, mirrored); });
  gap(theme, 4);
}

void draw_list(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  std::string filter = state.filter;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  if (ImGui::InputTextWithHint("##filter", "Filter by name, group or notes", &filter))
    out.change([filter](EditorState& s) { s.models.filter = filter; });
  const float left = ImGui::GetCursorPosX(), scrollbar = ImGui::GetStyle().ScrollbarSize;
  const float width = ImGui::GetContentRegionAvail().x - scrollbar;  // the same with and without one
  const Columns columns = columns_in(theme, width);
  draw_title(ui, "Name", CaseColumn::name, left + columns.name, columns.group - columns.name, false, "Sort by name",
             out);
  draw_title(ui, "Group", CaseColumn::group, left + columns.group, columns.state - columns.group, false,
             "Sort by group", out);
  draw_title(ui, "State", CaseColumn::state, left + columns.state - theme.px(6), theme.px(40), false,
             "Sort by state: to do, in work, done", out);
  draw_title(ui, "mm", CaseColumn::distance, left + columns.distance + theme.px(10),
             columns.right - columns.distance - theme.px(10), true,
             "Procrustes distance: root mean square over the landmarks to the mean shape, mm. Beyond the fences it is "
             "coloured.",
             out);
  ImGui::NewLine();
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  const StudyCase* selected = find_case(state.study, state.selected);
  ImGui::BeginChild("cases", {0, selected == nullptr ? 0 : -case_details_height(ui, *selected)});
  const auto listed = listed_cases(state);
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(listed.size()), theme.px(row_height));
  while (clipper.Step())
    for (int k = clipper.DisplayStart; k < clipper.DisplayEnd; ++k)
      draw_row(ui, state.study.cases[listed[static_cast<std::size_t>(k)]], width, out);
  if (listed.empty() && !state.study.cases.empty()) explanation(theme, "No case holds that.");
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

}  // namespace

void draw_case_table(const UiContext& ui, const RectPx& rect, Outbox& out) {
  begin_region("cases", rect, palette::surface, ui.theme.px(12));
  draw_buttons(ui, out);
  draw_mirrored(ui, out);
  draw_list(ui, out);
  if (const StudyCase* one = find_case(ui.state.models.study, ui.state.models.selected))
    draw_case_details(ui, *one, out);
  ImGui::End();
}

}  // namespace homolog
