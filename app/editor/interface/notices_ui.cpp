#include "app/editor/interface/cards.h"
#include "app/editor/interface/interface.h"

#include <algorithm>
#include <cmath>

#include "app/editor/state/icons.h"
#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/key_focus.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

float card_width(const UiContext& ui) {
  const Theme& theme = ui.theme;
  return std::min(static_cast<float>(theme.px(400)), ui.layout.panel.x - theme.px(32));
}

float top_of_cards(const UiContext& ui) {
  return ui.layout.top_bar.y + ui.layout.top_bar.height + ui.theme.px(layout_units::header_height + 8);
}

void begin_card(const UiContext& ui, const char* id, float height_px, float bottom_px, ImU32 edge, bool hangs) {
  const Theme& theme = ui.theme;
  ImGui::SetNextWindowPos({ui.layout.panel.x - theme.px(16), bottom_px}, ImGuiCond_Always, {1, hangs ? 0.0f : 1.0f});
  ImGui::SetNextWindowSize({card_width(ui), height_px});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, palette::raised);
  ImGui::PushStyleColor(ImGuiCol_Border, with_alpha(edge, 0.7f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  ImGui::Begin(id, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing | (height_px > 0 ? 0 : ImGuiWindowFlags_AlwaysAutoResize));
  ImGui::PopStyleVar();
  ImGui::PopStyleColor(2);
  // The card has the colour that buttons have elsewhere.
  ImGui::PushStyleColor(ImGuiCol_Button, palette::hovered);
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, palette::pressed);
  ImGui::PushStyleColor(ImGuiCol_ButtonActive, palette::faint);
  enter_part(id);
}

void end_card(const UiContext& ui, float& bottom_px) {
  bottom_px -= ImGui::GetWindowHeight() + ui.theme.px(8);
  leave_part();
  ImGui::PopStyleColor(3);
  ImGui::End();
}

namespace {

void dismiss_notice(std::size_t index, Outbox& out) {
  out.send(DismissNotice{index});
}

void draw_notice(const UiContext& ui, std::size_t index, float& bottom_px, Outbox& out) {
  const Theme& theme = ui.theme;
  const Notice& notice = ui.state.notices[index];
  const ImU32 colour = notice.error ? palette::bad : palette::accent;
  const float width = card_width(ui), left = theme.px(36), pad = theme.px(12), end = width - theme.px(44);
  const bool offers = !notice.kept.empty();
  const float button_px = offers ? theme.px(28) + theme.px(8) : 0;
  // The whole sentence; one that is taller than its share of the room, with those that follow, scrolls.
  const float lines = std::ceil(text_size(theme.body, in_lines(theme.body, notice.text, end - left)).y);
  const float share = (bottom_px - top_of_cards(ui)) / static_cast<float>(ui.state.notices.size() - index);
  const float most = std::max(std::floor(share - 2 * pad - button_px - theme.px(8)), theme.px(20));
  const float shown = std::min(lines, most);
  const float height = shown + 2 * pad + button_px;
  begin_card(ui, format("notice %zu", index).c_str(), height, bottom_px, colour);
  text_line(notice.error ? icon::warning : icon::info, colour);
  ImGui::SameLine(left);
  if (shown < lines) {
    ImGui::BeginChild("sentence", {end - left + theme.px(12), shown});
    text_lines(notice.text, palette::text, end - left);
    ImGui::EndChild();
  } else {
    text_lines(notice.text, palette::text, end);
  }
  if (offers) {
    ImGui::SetCursorPosX(left);
    if (button(theme, "Open it again", notice.kept.string(),
               ButtonOptions{.width_px = theme.px(140), .primary = true})) {
      if (is_study_file(notice.kept))
        out.send(OpenStudy{{notice.kept}});
      else
        out.send(open_case_file(notice.kept));
      dismiss_notice(index, out);
    }
  }
  ImGui::SetCursorPos({width - theme.px(32), theme.px(8)});
  if (icon_button(theme, icon::close, "dismiss", "Dismiss (Escape)", {}, false, 24)) dismiss_notice(index, out);
  end_card(ui, bottom_px);
}

void draw_work(const UiContext& ui, const RunningWork& work, float& bottom_px, Outbox& out) {
  const Theme& theme = ui.theme;
  const float height = theme.px(12 + 28 + 8 + 4 + 12), cancel = card_width(ui) - theme.px(12 + 76);
  begin_card(ui, work.kind, height, bottom_px, palette::accent);
  ImGui::AlignTextToFramePadding();
  const std::string what = shortened(work.what, cancel - theme.px(24));
  text_line(what);
  if (what != work.what && is_explained()) tooltip(theme, work.what);
  ImGui::SameLine(cancel);
  if (button(theme, "Cancel", work.cancel_tip, work.no_cancel, theme.px(76))) out.send(work.cancel);
  progress_bar(theme, work.fraction);
  end_card(ui, bottom_px);
}

}  // namespace

RunningWork study_work(const RunningJob& job) {
  const std::string_view verb = job.verb;
  const bool writes = verb.starts_with("Writing");
  return {"study",
          job.verb + (" " + std::filesystem::path(job.subject).filename().string()),
          verb.starts_with("Reading") ? "The study on the screen stays as it is" : "The shape stays as it is",
          CancelStudyFile{job.subject},
          job.fraction,
          writes ? "Writing a study cannot be stopped. It ends soon." : ""};
}

void draw_notices(const UiContext& ui, Outbox& out) {
  const KeyGroup group("cards");
  float bottom_px = ui.layout.status_line.y - ui.theme.px(16);
  // What runs stays where it is, and a new notice moves none of those that are there.
  for (const RunningWork& work : ui.running) draw_work(ui, work, bottom_px, out);
  for (std::size_t i = 0; i < ui.state.notices.size(); ++i) draw_notice(ui, i, bottom_px, out);
  draw_guide(ui, bottom_px, out);
}

}  // namespace homolog
