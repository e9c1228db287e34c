#include <cmath>

#include "app/editor/interface/interface.h"
#include "app/editor/interface/marks/view_marks.h"
#include "app/editor/interface/side_buttons.h"
#include "app/editor/state/icons.h"
#include "app/editor/state/views.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/key_focus.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

void draw_header(const UiContext& ui, ViewKind kind, Outbox& out) {
  const Theme& theme = ui.theme;
  const RectPx& rect = ui.layout.headers[index_of(kind)];
  const std::string title = view_title(kind, geometry_of(ui.document()), ui.state.look.own_planes);
  begin_region(("header " + title).c_str(), rect, palette::surface);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled({rect.x, rect.y}, {rect.x + theme.px(3), rect.y + rect.height}, view_hue(kind));
  ImGui::PushFont(theme.strong);
  const float text_y = std::floor(rect.y + (rect.height - ImGui::GetFontSize()) / 2);
  text_at(draw, {rect.x + theme.px(12), text_y}, title_hue(kind), title);
  const float title_width = ImGui::CalcTextSize(title.c_str()).x;
  ImGui::PopFont();

  if (kind != ViewKind::space) {
    const Vec3 normal = slice_view(ui.state, kind, geometry_of(ui.document())).normal();
    const double along = normal.dot(ui.state.look.crosshair_mm);
    const std::string letters = direction_letters(along < 0 ? Vec3(-normal) : normal);
    const std::string position = format("%s %.1f mm", letters.c_str(), std::abs(along));
    const EvenDigits digits(theme);
    text_at(draw, {rect.x + theme.px(24) + title_width, text_y}, palette::dim, position);
  }

  const float side = theme.px(24), top = theme.px(2);
  ImGui::SetCursorPos({rect.width - side - theme.px(4), top});
  const bool whole = ui.state.look.maximised == kind;
  if (icon_button(theme, whole ? icon::shrink : icon::enlarge, "maximise",
                  whole ? "All four views (double-click)" : "This view alone (double-click)", {}, false, 24))
    out.send(MaximiseView{whole ? std::nullopt : std::optional(kind)});
  if (kind == ViewKind::space && rect.width > theme.px(260))
    draw_side_buttons<LookFromSide>(ui, rect.width - 8 * side - theme.px(4), top, side, "", out);
  end_region();
}

/// What the pointer's shape tells: what a press would take hold of, or what the drag does.
ImGuiMouseCursor pointer_shape(const EditorState& state) {
  if (state.pointer.drag && is_of_view(*state.pointer.drag)) return ImGuiMouseCursor_ResizeAll;
  switch (kind_of(state.pointer.drag ? state.pointer.begun_with : state.hand.tool).cursor(state)) {
    case PointerShape::arrow:
      return ImGuiMouseCursor_Arrow;
    case PointerShape::hand:
      return ImGuiMouseCursor_Hand;
    case PointerShape::move:
      return ImGuiMouseCursor_ResizeAll;
    case PointerShape::scale:
      return ImGuiMouseCursor_ResizeNWSE;
  }
  return ImGuiMouseCursor_Arrow;
}

/// Whether the guide's next pull is done in a view.
bool has_guides_pull(const UiContext& ui, ViewKind kind) {
  const auto& guide = ui.state.guide;
  return guide && guide->shown && guide->at < guide->steps.size() && guide->steps[guide->at].view == kind;
}

}  // namespace

void draw_views(const UiContext& ui, Outbox& out) {
  static constexpr std::array<const char*, 4> parts{"axial view", "sagittal view", "coronal view", "3D view"};
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const KeyGroup group("headers of the views");
  for (const ViewKind kind : all_views) {
    const RectPx& rect = ui.layout.image(kind);
    if (rect.width < 1 || rect.height < 1) continue;
    const ImVec2 low{rect.x, rect.y}, high{rect.x + rect.width, rect.y + rect.height};
    draw.PushClipRect(low, high);
    enter_part(parts[index_of(kind)]);
    draw_view_marks(ui, kind, draw);
    leave_part();
    draw.PopClipRect();
    const bool under_pointer = ui.state.pointer.hover && ui.state.pointer.hover->view == kind;
    draw.AddRect(low, high, with_alpha(view_hue(kind), under_pointer ? 0.9f : 0.35f));
    if (has_guides_pull(ui, kind)) draw.AddRect(low, high, palette::accent, 0, 0, ui.theme.px(2));
    draw_header(ui, kind, out);
  }
  if (ui.state.pointer.drag || ui.state.pointer.hover) ImGui::SetMouseCursor(pointer_shape(ui.state));
}

}  // namespace homolog
