#include <cmath>
#include <cstdint>

#include "app/editor/drawing/case_thumbnails.h"
#include "app/editor/panels/models/models_panel.h"
#include "app/editor/state/files/file_extensions.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/text/listed.h"

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
  const ModelsState& state = ui.state.models;
  if (!begin_menu(theme, "study menu")) return;
  const auto ask = [&](FilePurpose purpose, std::string name = {}) { out.send(ShowFileDialog{purpose, name}); };
  if (menu_item(theme, "New study\xe2\x80\xa6", nullptr)) ask(FilePurpose::new_study, "cohort.study.json");
  if (menu_item(theme, "Open study\xe2\x80\xa6", "Ctrl+O")) ask(FilePurpose::open_study);
  if (!state.kept.file.empty()) {
    if (menu_item(theme, "Save study as\xe2\x80\xa6", "Ctrl+S"))
      ask(FilePurpose::save_study, state.kept.file.filename().string());
    const std::string now =
        state.study.template_file.empty() ? "" : ". Chosen now: " + state.study.template_file.string();
    if (menu_item(theme, "Set the template\xe2\x80\xa6", nullptr,
                  "Choose a mesh with the numbering of the shapes. It gives .particles files their faces" + now))
      ask(FilePurpose::open_study_template);
    if (const std::size_t maps = cases_with_labels(state); maps > 1 && !state.runs.listing)
      if (menu_item(theme, "Make a consensus template\xe2\x80\xa6", nullptr,
                    format("The mean shape of the %zu label maps, which no single subject decides. Cases that wait "
                           "begin with it",
                           maps)))
        ask(FilePurpose::make_study_template, study_stem(state) + "-template.ply");
  }
  if (!state.shapes.shown.empty()) {
    menu_line();
    const auto export_as = [&](const char* label, const char* extension) {
      const char* const what = state.made.optimisation.shown ? "Writes the optimised shapes, as they are shown"
                                                             : "Writes every shape of the study";
      if (!menu_item(theme, label, nullptr, what)) return;
      out.send(ChooseShapesFolder{extension, study_stem(state) + "-shapes"});
    };
    export_as("Export shapes as imported\xe2\x80\xa6", "");
    export_as("Export shapes as .ply\xe2\x80\xa6", ".ply");
    export_as("Export shapes as .particles\xe2\x80\xa6", ".particles");
  }
  menu_line();
  if (menu_item(theme, "Phantom vertebrae (10 subjects)", nullptr)) out.send(OpenPhantomStudy{Organ::vertebra});
  if (menu_item(theme, "Phantom kidneys (16 subjects)", nullptr)) out.send(OpenPhantomStudy{Organ::kidney});
  if (menu_item(theme, "Phantom ventricle (20 phases)", nullptr)) out.send(OpenPhantomStudy{Organ::ventricle});
  end_menu(theme);
}

void draw_buttons(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const float next = theme.px(28), width = (ImGui::GetContentRegionAvail().x - next - 2 * theme.px(8)) / 2;
  if (button(theme, std::string("Study  ") + icon::down_angle, "New, open, save as, phantoms", {}, width))
    open_menu("study menu");
  const ImVec2 below{ImGui::GetItemRectMin().x, ImGui::GetItemRectMax().y + theme.px(4)};
  ImGui::SetNextWindowPos(below);
  draw_study_menu(ui, out);
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, std::string(icon::plus) + "  Meshes\xe2\x80\xa6",
             "Add cases or meshes (" + listed(shape_extensions(), ", ") + "). Or drop them on the window", {}, width))
    out.send(ShowFileDialog{FilePurpose::add_shapes, {}});
  ImGui::SameLine(0, theme.px(8));
  if (icon_button(theme, icon::next, "next", "Next case that is not done (N)",
                  state.study.next_case() < 0 ? "Every case is done." : "", false, 28))
    out.send(SelectNextCase{});
}

/// Scans that become cases, and the fit of those that wait.
void draw_worklist(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const float width = (ImGui::GetContentRegionAvail().x - theme.px(8)) / 2;
  if (state.runs.listing) {
    // As high as the two buttons, and Cancel is not where the fit was started.
    if (button(theme, "Cancel", "Stops. Cases that are fitted already stay fitted", {}, width))
      out.send(CancelWorklist{});
    ImGui::SameLine(0, theme.px(8));
    ImGui::BeginGroup();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, theme.px(2)});
    text_line(shortened(state.runs.listing_what, width), palette::dim);
    progress_bar(theme, state.runs.listing_fraction);
    ImGui::PopStyleVar();
    ImGui::EndGroup();
    return;
  }
  if (button(theme, std::string(icon::plus) + "  Scans\xe2\x80\xa6",
             "Adds a folder of scans or label maps (or drop it on the window). Each becomes a waiting case", {}, width))
    out.send(ShowFileDialog{FilePurpose::add_scans, {}});
  ImGui::SameLine(0, theme.px(8));
  const std::size_t waiting = waiting_cases(state);
  if (button(theme, waiting == 0 ? std::string("Fit waiting") : format("Fit waiting (%zu)", waiting),
             "Fits every waiting case to its label map. Then the list shows cases in doubt first",
             waiting == 0 ? "No case with a label map waits." : "", width))
    out.send(FitWaiting{});
}

/// A title of the list that sorts it.
void draw_title(const UiContext& ui, const char* text, CaseColumn column, float x_px, float width_px, bool at_right,
                const char* tip, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  ImGui::SetCursorPosX(x_px);
  const ImVec2 at = ImGui::GetCursorScreenPos(), size{width_px, theme.px(20)};
  const bool sorted = state.list.sorted_by == column;
  const auto title = area(theme, text, size, tip, {sorted});
  if (title.clicked) out.send(SortCases{column});
  const ImU32 colour = title.hovered ? palette::accent : sorted ? palette::text : palette::dim;
  const std::string label =
      std::string(text) +
      (sorted ? std::string(" ") + (state.list.descending ? icon::down_angle : icon::arrow_up) : "");
  ImGui::PushFont(theme.small);
  const float width = ImGui::CalcTextSize(label.c_str()).x;
  text_at(*ImGui::GetWindowDrawList(), {at_right ? at.x + size.x - width : at.x, at.y + theme.px(2)}, colour, label);
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
  constexpr float least_with_pictures = 270;
  c.name = c.picture + (width_px < theme.px(least_with_pictures) ? 0 : theme.px(CaseThumbnails::width + 6));
  return c;
}

ImU32 distance_colour(const StudyModel& model, std::ptrdiff_t shape) {
  for (const SuspiciousShape& one : model.suspicious_shapes)
    if (one.shape == shape) return one.suspicion == Suspicion::far_outside ? palette::bad : palette::amber;
  return palette::dim;
}

std::string row_tip(const StudyCase& one, bool left_out) {
  std::string tip = one.name + "\n" + one.file.string();
  if (left_out) tip += one.waits() ? "\nWaits to be fitted, so it is not in the model yet." : "\nNot in the model.";
  if (!one.doubt.empty()) tip += "\n" + one.doubt;
  if (!one.notes.empty()) tip += "\n" + one.notes;
  return tip + (is_case_file(one.file) ? "\nDouble-click opens it." : "\nDouble-click opens it for repair.");
}

void draw_row(const UiContext& ui, const StudyCase& one, const std::vector<std::string>& names, float width_px,
              Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const Part part(one.name, "case");
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{width_px, theme.px(row_height)};
  const Columns columns = columns_in(theme, size.x);
  const bool selected = state.list.selected == one.name;
  const auto shape = state.made.model ? state.made.model->index_of(one.name) : -1;
  const bool left_out = state.made.model && shape < 0;
  const auto row = area(theme, "row", size, row_tip(one, left_out), {selected, true});
  if (row.clicked) out.send(SelectCase{one.name});
  if (row.doubled) out.send(OpenCaseOfStudy{one.name, {}});
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (selected || row.hovered)
    draw.AddRectFilled(at, {at.x + size.x, at.y + size.y},
                       selected ? with_alpha(palette::accent, 0.25f) : palette::raised, theme.px(4));
  const float y = at.y + std::floor((size.y - ImGui::GetFontSize()) / 2);
  const bool has_picture = columns.name > columns.picture;
  if (const unsigned texture = has_picture ? ui.thumbnails.texture(one.name) : 0U) {
    const ImVec2 corner{std::floor(at.x + columns.picture),
                        std::floor(at.y + (size.y - theme.px(CaseThumbnails::height)) / 2)};
    draw.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(texture)), corner,
                  {corner.x + theme.px(CaseThumbnails::width), corner.y + theme.px(CaseThumbnails::height)});
  }
  const float name_room = columns.state - columns.name - theme.px(8) - (one.notes.empty() ? 0 : theme.px(20));
  const std::string name = shortened_among(one.name, names, name_room);
  const float name_y = one.group.empty() ? y : std::floor(at.y + theme.px(3));
  const ImU32 colour = one.waits()                      ? palette::dim
                       : left_out || !one.doubt.empty() ? (left_out ? palette::bad : palette::amber)
                                                        : palette::text;
  text_at(draw, {at.x + columns.name, name_y}, colour, name);
  if (!one.notes.empty())
    text_at(draw, {at.x + columns.name + ImGui::CalcTextSize(name.c_str()).x + theme.px(6), name_y}, palette::dim,
            icon::note);
  if (!one.group.empty()) {
    ImGui::PushFont(theme.small);
    text_at(draw, {at.x + columns.name, std::floor(at.y + theme.px(21))}, palette::dim,
            shortened(one.group, columns.state - columns.name - theme.px(8)));
    ImGui::PopFont();
  }
  if (const auto distance = distance_mm(state, one)) {
    const EvenDigits digits(theme);
    const std::string text = format("%.2f", *distance);
    text_at(draw, {at.x + columns.right - ImGui::CalcTextSize(text.c_str()).x, y},
            distance_colour(*state.made.model, shape), text);
  }
  ImGui::SetCursorScreenPos({at.x + columns.state, at.y});
  if (area(theme, "state", {theme.px(24), size.y},
           std::string("State: ") + state_name(one.state) + ". Click for the next.")
          .clicked)
    out.send(CycleCaseState{one.name});
  text_at(draw, {at.x + columns.state + theme.px(4), y}, state_colour(one.state), state_icon(one.state));
}

/// Says which shapes are mirror images, with the offer to flip them.
void draw_mirrored(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& mirrored = ui.state.models.shapes.mirrored;
  if (mirrored.empty()) return;
  // As many whole names as three lines hold.
  std::string names;
  std::size_t named = 0;
  for (const std::string& name : mirrored) {
    const std::string more = (named == 0 ? "" : ", ") + name;
    if (named > 0 && ImGui::CalcTextSize((names + more).c_str()).x > 3 * ImGui::GetContentRegionAvail().x) break;
    names += more;
    ++named;
  }
  if (named < mirrored.size()) names += format(" and %zu more", mirrored.size() - named);
  text_lines(mirrored.size() == 1
                 ? names + " is a mirror image of the other shapes."
                 : format("%zu shapes are mirror images of the others: ", mirrored.size()) + names + ".",
             palette::amber);
  if (button(theme, mirrored.size() == 1 ? "Flip it (left and right)" : "Flip them (left and right)",
             "Only in this study. The files are not changed", {}, ImGui::GetContentRegionAvail().x))
    out.send(FlipCases{mirrored});
  gap(theme, 4);
}

void draw_list(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  std::string filter = state.list.filter;
  if (text_field(theme, "filter", filter, "Filter by name, group or notes", ImGui::GetContentRegionAvail().x, 28))
    out.send(FilterCases{filter});
  const float left = ImGui::GetCursorPosX(), scrollbar = ImGui::GetStyle().ScrollbarSize;
  const float width = ImGui::GetContentRegionAvail().x - scrollbar;  // the same with and without one
  const Columns columns = columns_in(theme, width);
  draw_title(ui, "Name", CaseColumn::name, left + columns.name, columns.group - columns.name, false, "Sort by name",
             out);
  draw_title(ui, "Group", CaseColumn::group, left + columns.group, columns.state - columns.group - theme.px(8), false,
             "Sort by group", out);
  draw_title(ui, "State", CaseColumn::state, left + columns.state - theme.px(6), theme.px(40), false,
             "Sort by state: to do, in work, done", out);
  draw_title(
      ui, "mm", CaseColumn::distance, left + columns.distance + theme.px(10),
      columns.right - columns.distance - theme.px(10), true,
      "Procrustes distance to the mean shape: root mean square over the vertices, mm. Unusual values are coloured.",
      out);
  ImGui::NewLine();
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  const StudyCase* selected = find_case(state.study, state.list.selected);
  ImGui::BeginChild("cases", {0, selected == nullptr ? 0 : -case_details_height(ui, *selected)});
  const auto listed = listed_cases(state);
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(listed.size()), theme.px(row_height));
  while (clipper.Step()) {
    const auto first = listed.begin() + clipper.DisplayStart, last = listed.begin() + clipper.DisplayEnd;
    std::vector<std::string> names;  // of the rows on the screen
    for (auto k = first; k != last; ++k) names.push_back(state.study.cases[*k].name);
    for (auto k = first; k != last; ++k) draw_row(ui, state.study.cases[*k], names, width, out);
  }
  if (listed.empty() && !state.study.cases.empty()) explanation(theme, "No match.");
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

}  // namespace

void draw_case_table(const UiContext& ui, const RectPx& rect, Outbox& out) {
  begin_region("cases", rect, palette::surface, ui.theme.px(12));
  draw_buttons(ui, out);
  draw_worklist(ui, out);
  draw_mirrored(ui, out);
  draw_list(ui, out);
  if (const StudyCase* one = find_case(ui.state.models.study, ui.state.models.list.selected))
    draw_case_details(ui, *one, out);
  end_region();
}

}  // namespace homolog
