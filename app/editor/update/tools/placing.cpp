#include "app/editor/state/icons.h"
#include "app/editor/update/tools/tool.h"

namespace homolog {

namespace {

PointerShape cursor_of_part(const EditorState& state) {
  if (state.pointer.drag)
    return std::get<PlaceDrag>(*state.pointer.drag).part == PlacePart::knob ? PointerShape::scale : PointerShape::move;
  switch (state.pointer.hover ? state.pointer.hover->part : PlacePart::none) {
    case PlacePart::none:
      return PointerShape::arrow;
    case PlacePart::body:
      return PointerShape::move;
    case PlacePart::ring:
      return PointerShape::hand;
    case PlacePart::knob:
      return PointerShape::scale;
  }
  return PointerShape::arrow;
}

bool begin_placing(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (hover.part == PlacePart::none || !press.shape()) return false;
  press.stay_at_frame();
  PlaceDrag drag;
  drag.view = hover.view;
  drag.part = hover.part;
  drag.start = drag.now = press.shape()->shape.placement;
  drag.centre_mm = bounds_of(*press.shape()->shape.points).center();
  drag.press_mm = press.map().on_facing_plane(press.event.x_px, press.event.y_px, drag.centre_mm);
  state.pointer.drag = drag;
  return true;
}

void move_placing(const DragStep& step) {
  auto& drag = std::get<PlaceDrag>(*step.state.pointer.drag);
  drag.now = dragged_placement(drag, step.map(drag.view), step.event.x_px, step.event.y_px);
  step.out.preview(SetPlacement{drag.now});
}

std::optional<Action> placing_action(const EditorState& state) {
  const auto& drag = std::get<PlaceDrag>(*state.pointer.drag);
  return drag.now == drag.start ? std::nullopt : std::optional<Action>(SetPlacement{drag.now});
}

std::string placing_hint(const EditorState&, const Document&) {
  return "Drag the mesh to move it, the ring to turn it, the knob to scale it.";
}

}  // namespace

constinit const ToolKind place_tool{.tool = MouseTool::place,
                                    .name = "Place",
                                    .log_name = "place",
                                    .key = "M",
                                    .in_keys = "Place",
                                    .glyph = icon::place,
                                    .tip = "Place (M): move, turn (ring) and scale (knob) the template",
                                    .section = place_section,
                                    .marks = ToolMarks::handles,
                                    .cursor = cursor_of_part,
                                    .hint = placing_hint,
                                    .begin = begin_placing,
                                    .move = move_placing,
                                    .action = placing_action};

}  // namespace homolog
