#include "app/editor/panels/models_ui.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/widgets/drawn_items.h"

namespace homolog {

void begin_region(const char* name, const RectPx& rect, ImU32 colour, float padding_px) {
  ImGui::SetNextWindowPos({rect.x, rect.y});
  ImGui::SetNextWindowSize({rect.width, rect.height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {padding_px, padding_px});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(3);
  enter_part(name);
}

void end_region() {
  leave_part();
  ImGui::End();
}

void draw_interface(const UiContext& ui, Outbox& out) {
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
