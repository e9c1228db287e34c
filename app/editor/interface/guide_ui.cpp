#include "app/editor/interface/cards.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/editor/update/controls.h"
#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

/// Each names the view of its step; see guide_to().
constexpr std::array<const char*, 5> texts{
    "The template is placed already, but it is too small. In the coronal view, drag the dot at the upper end along the "
    "arrow to its bar, the edge of the kidney.",
    "In the coronal view, drag the dot at the lower end to the bar. Turn the wheel while you drag to make the pull "
    "wider or narrower.",
    "In the axial view, drag the dot at the outer side to the bar. The shape between your pulls follows smoothly.",
    "In the sagittal view, drag the dot at the front to the bar. Ctrl+Z undoes a wrong drag.",
    "In the sagittal view, drag the dot at the back to the bar. Between drags, the wheel goes through the slices; Show "
    "brings the arrow back."};

bool meet(const RectPx& a, const RectPx& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/// Whether the card gives way to the pull and lies at the views' upper edge: at the lower one it would cover the view
/// of the pull, or where that fills the window the arrow.
bool lies_above(const UiContext& ui, float bottom_px) {
  const Guide& guide = *ui.state.guide;
  if (guide.at >= guide.steps.size() || !ui.has_shape()) return false;
  const GuideStep& step = guide.steps[guide.at];
  const RectPx& view = ui.layout.image(step.view);
  const float width = card_width(ui), height = ui.theme.px(160);
  const RectPx below{ui.layout.panel.x - ui.theme.px(16) - width, bottom_px - height, width, height};
  RectPx above = below;
  above.y = top_of_cards(ui);
  if (!meet(below, view) || !meet(above, view)) return meet(below, view);
  const auto at = view_map(ui.state, ui.layout, ui.document(), step.view).to_px(step.to_mm);
  const float reach = ui.theme.px(48);
  return at &&
         meet(below, {static_cast<float>(at->x()) - reach, static_cast<float>(at->y()) - reach, 2 * reach, 2 * reach});
}

}  // namespace

void draw_guide(const UiContext& ui, float& bottom_px, Outbox& out) {
  if (!ui.state.guide || !ui.state.guide->shown || ui.state.models.shown) return;
  const Theme& theme = ui.theme;
  const Guide& guide = *ui.state.guide;
  const bool above = lies_above(ui, bottom_px);
  begin_card(ui, "guide", 0, above ? top_of_cards(ui) : bottom_px, palette::accent, above);
  const bool all_done = guide.at >= guide.steps.size();
  const float width = card_width(ui) - theme.px(24), fourth = std::floor((width - 3 * theme.px(8)) / 4);
  caption(theme, all_done ? "First steps: done"
                          : format("First steps: pull %zu of %zu", guide.at + 1, guide.steps.size()).c_str());
  text_lines(all_done ? "The outline lies near the kidney everywhere. Press Snap the whole mesh (Deform). Then "
                        "save the case (Ctrl+S), or open a scan of your own (Ctrl+O)."
                      : texts[std::min(guide.at, texts.size() - 1)],
             palette::text, width);
  gap(theme, 4);
  if (button(theme, "Back", "The pull before", guide.at == 0 ? "This is the first pull." : "", fourth))
    out.send(MoveInGuide{-1});
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Show", "Brings the view, its slice and the arrow of this pull back",
             all_done ? "All pulls are done." : "", fourth))
    out.send(MoveInGuide{0});
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Skip", "The next pull", all_done ? "All pulls are done." : "", fourth)) out.send(MoveInGuide{1});
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Close", "Case, First steps… shows the guide again",
             ButtonOptions{.width_px = fourth, .primary = all_done}))
    out.send(ShowGuide{false});
  end_card(ui, bottom_px);
}

}  // namespace homolog
