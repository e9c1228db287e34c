#include "app/editor/state/icons.h"
#include "app/editor/update/tools/tool.h"

namespace homolog {

namespace {

PointerShape ruler_cursor(const EditorState& state) {
  return state.pointer.drag ? PointerShape::arrow : hand_over_landmarks(state);
}

bool begin_ruler(const Press& press) {
  if (!press.hover.p_mm) return false;
  press.state.hand.ruler = Ruler{*press.hover.p_mm, *press.hover.p_mm};
  press.state.pointer.drag = RulerDrag{press.hover.view};
  return true;
}

void move_ruler(const DragStep& step) {
  // In space both ends lie on the surface: a length across the screen would be too short.
  if (const auto over = step.over(std::get<RulerDrag>(*step.state.pointer.drag).view))
    step.state.hand.ruler->to = *over;
}

void finish_ruler(EditorState& state) {
  if (state.hand.ruler->length_mm() == 0) state.hand.ruler.reset();
}

std::string ruler_hint(const EditorState& state, const Document&) {
  return state.hand.ruler ? "Drag again to measure something else. Escape removes the ruler."
                          : "Drag from one point to another.";
}

}  // namespace

constinit const ToolKind ruler_tool{.tool = MouseTool::ruler,
                                    .name = "Ruler",
                                    .log_name = "ruler",
                                    .key = "D",
                                    .in_keys = "Ruler",
                                    .glyph = icon::ruler,
                                    .tip = "Ruler (D): drag to measure a distance in mm",
                                    .needs_image = true,
                                    .cursor = ruler_cursor,
                                    .hint = ruler_hint,
                                    .follows_mesh = true,
                                    .edits_at = [](const Hover&) { return false; },
                                    .begin = begin_ruler,
                                    .move = move_ruler,
                                    .finish = finish_ruler,
                                    .cancel = [](EditorState& state) { state.hand.ruler.reset(); }};

}  // namespace homolog
