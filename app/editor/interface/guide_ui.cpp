#include "app/editor/interface/cards.h"
#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

constexpr std::array<const char*, 5> texts{
    "In the coronal view, drag the upper end of the outline to the edge of the kidney, along the arrow.",
    "Now drag the lower end. Turn the wheel while you drag to make the pull wider or narrower.",
    "In the axial view, drag the outer side to the edge. The shape between your pulls follows smoothly.",
    "In the sagittal view, drag the front to the edge. Ctrl+Z undoes a wrong drag.",
    "Now drag the back. Between drags, the wheel goes through the slices."};

}  // namespace

void draw_guide(const UiContext& ui, float& bottom_px, Outbox& out) {
  if (!ui.state.guide || !ui.state.guide->shown) return;
  const Theme& theme = ui.theme;
  const Guide& guide = *ui.state.guide;
  begin_card(ui, "guide", 0, bottom_px, palette::accent);
  const bool all_done = guide.at >= guide.steps.size();
  const float width = card_width(ui) - theme.px(24), third = (width - 2 * theme.px(8)) / 3;
  caption(theme, all_done ? "First steps: done"
                          : format("First steps: pull %zu of %zu", guide.at + 1, guide.steps.size()).c_str());
  text_lines(all_done ? "The outline lies near the kidney everywhere. Press Snap the whole mesh (Deform). Then "
                        "save the case (Ctrl+S), or open a scan of your own (Ctrl+O)."
                      : texts[std::min(guide.at, texts.size() - 1)],
             palette::text, width);
  gap(theme, 4);
  if (button(theme, "Back", "The pull before", guide.at == 0 ? "This is the first pull." : "", third))
    out.send(MoveInGuide{-1});
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Skip", "The next pull", all_done ? "All pulls are done." : "", third)) out.send(MoveInGuide{1});
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Close", "Case, First steps… shows the guide again", {}, third, all_done))
    out.send(ShowGuide{false});
  end_card(ui, bottom_px);
}

}  // namespace homolog
