#include "app/editor/interface/interface.h"
#include "app/editor/panels/models/models_panel.h"
#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"

namespace homolog {

namespace {

/// The pointer that keys move: the system shows the mouse's.
void draw_key_pointer(const Theme& theme) {
  const ImVec2 at = ImGui::GetIO().MousePos;
  ImDrawList& draw = *ImGui::GetForegroundDrawList();
  const float inner = theme.px(3), outer = theme.px(9);
  for (const auto& [colour, width] : {std::pair(palette::mark_shadow, 4.0f), std::pair(palette::mark, 2.0f)}) {
    draw.AddCircle(at, theme.px(6), colour, 0, theme.scale * width);
    for (const ImVec2 way : {ImVec2{1, 0}, ImVec2{-1, 0}, ImVec2{0, 1}, ImVec2{0, -1}})
      draw.AddLine({at.x + inner * way.x, at.y + inner * way.y}, {at.x + outer * way.x, at.y + outer * way.y}, colour,
                   theme.scale * width);
  }
}

}  // namespace

void draw_interface(const UiContext& ui, Outbox& out) {
  if (controls_memory().pointer_by_keys && !ui.state.dialog) draw_key_pointer(ui.theme);
  if (ui.state.models.shown) return draw_models_interface(ui, out);
  draw_views(ui, out);
  draw_top_bar(ui, out);
  draw_tool_strip(ui, out);
  if (ui.layout.panel.width > 0) draw_side_panel(ui, out);
  draw_status_line(ui, out);
  draw_notices(ui, out);
  draw_dialogs(ui, out);
}

}  // namespace homolog
