#include <algorithm>
#include <cmath>

#include "app/editor/panels/models/models_panel.h"
#include "app/editor/state/icons.h"
#include "app/editor/widgets/widgets.h"

// What the list of cases shows of the selected one.

namespace homolog {

namespace {

bool offers_flip(const ModelsState& state, const StudyCase& one) {
  return one.flipped ||
         std::find(state.shapes.mirrored.begin(), state.shapes.mirrored.end(), one.name) != state.shapes.mirrored.end();
}

/// A text of the selected case; it counts when the field is left.
void draw_text_field(const UiContext& ui, const StudyCase& one, const char* field, const char* hint,
                     const std::string& committed, Outbox& out) {
  const auto& edit = ui.state.models.list.text_edit;
  const std::string key = one.name + '\n' + field;
  std::string text = edit && edit->field == key ? edit->text : committed;
  ImGui::PushID(one.name.c_str());
  const bool changed = text_field(ui.theme, field, text, hint, ImGui::GetContentRegionAvail().x, 28);
  ImGui::PopID();
  if (changed) out.send(TypeCaseText{CaseTextEdit{key, text}});
  if (!field_left()) return;
  out.send(SetCaseText{one.name, field, text});
}

void draw_flip(const UiContext& ui, const StudyCase& one, Outbox& out) {
  if (!offers_flip(ui.state.models, one)) return;
  bool flipped = one.flipped;
  if (toggle(ui.theme, "Flipped (left and right)", flipped, "Only in this study. The file is not changed"))
    out.send(FlipCases{{one.name}});
}

void draw_frames(const UiContext& ui, const StudyCase& one, Outbox& out) {
  const std::size_t count = other_frames(ui.state.models, one).size();
  if (count == 0) return;
  if (button(ui.theme, format("Add its %zu other %s as cases", count, count == 1 ? "frame" : "frames"),
             "Each edited frame of the cine becomes a case of the study", {}, ImGui::GetContentRegionAvail().x))
    out.send(AddFrames{one.name});
}

}  // namespace

namespace {

/// "14 gestures in 3 min 20 s"
std::string work_on(const StudyCase& one) {
  const auto seconds = static_cast<long>(std::lround(one.seconds));
  const std::string time =
      seconds < 60 ? format("%ld s", seconds) : format("%ld min %ld s", seconds / 60, seconds % 60);
  return format("%lld %s in ", static_cast<long long>(one.gestures), one.gestures == 1 ? "edit" : "edits") + time;
}

bool says_work(const StudyCase& one) {
  return one.gestures > 0 || !one.doubt.empty();
}

}  // namespace

float case_details_height(const UiContext& ui, const StudyCase& one) {
  constexpr float plain = 206, row = 36;  // layout units
  const ModelsState& state = ui.state.models;
  float more_lines = 0;  // of a doubt, beyond its first
  if (!one.doubt.empty()) {
    const float width = ImGui::GetContentRegionAvail().x;
    more_lines = text_size(ImGui::GetFont(), in_lines(ImGui::GetFont(), one.doubt, width)).y - ImGui::GetFontSize();
  }
  return more_lines + ui.theme.px(plain + (offers_flip(state, one) ? row : 0) +
                                  (other_frames(state, one).empty() ? 0 : row) + (says_work(one) ? row : 0));
}

void draw_case_details(const UiContext& ui, const StudyCase& one, Outbox& out) {
  const Theme& theme = ui.theme;
  const Part part("selected case");
  gap(theme, 0);
  rule(theme);
  ImGui::PushFont(theme.strong);
  text_line(shortened(one.name, ImGui::GetContentRegionAvail().x));
  ImGui::PopFont();
  if (!one.doubt.empty())
    text_lines(one.doubt, palette::amber);
  else if (says_work(one))
    text_line(work_on(one), palette::dim);
  int chosen = static_cast<int>(one.state);
  if (choice(theme, "state", {"To do", "In work", "Done"}, chosen, {.tips = {"Not begun", "Begun", "Finished"}}))
    out.send(SetCaseState{one.name, static_cast<CaseState>(chosen)});
  draw_text_field(ui, one, "group", "Group, e.g. healthy", one.group, out);
  draw_text_field(ui, one, "notes", "Notes", one.notes, out);
  const float width = (ImGui::GetContentRegionAvail().x - theme.px(8)) / 2;
  if (is_case_file(one.file)
          ? button(theme, std::string(icon::open) + "  Open", "Open the case in the editor (Enter)", {}, width)
          : button(
                theme, std::string(icon::open) + "  Repair",
                "Makes a case from the mesh and opens it (Enter). The case file lies beside the study. The mesh file "
                "is not changed",
                {}, width))
    out.send(OpenCaseOfStudy{one.name, {}});
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, std::string(icon::trash) + "  Remove", "Removes the case from the study. Its file stays", {},
             width))
    out.send(RemoveCase{one.name});
  draw_flip(ui, one, out);
  draw_frames(ui, one, out);
}

}  // namespace homolog
