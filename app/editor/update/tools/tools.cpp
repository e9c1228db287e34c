#include <cassert>

#include "app/editor/update/tools/tool.h"

namespace homolog {

const ToolKind& kind_of(MouseTool tool) {
  const ToolKind& kind = *tool_kinds[static_cast<std::size_t>(tool)];
  assert(kind.tool == tool);
  return kind;
}

const ToolKind* dragging_tool(const EditorState& state) {
  if (!state.pointer.drag || is_of_view(*state.pointer.drag)) return nullptr;
  return &kind_of(state.pointer.begun_with);
}

bool is_brush(MouseTool tool) {
  return kind_of(tool).marks == ToolMarks::brush_circle;
}

bool edits_mesh_at(const Hover& hover) {
  return hover.on_mesh || hover.part != PlacePart::none;
}

PointerShape hand_over_mesh(const EditorState& state) {
  if (state.pointer.drag) return PointerShape::hand;
  return state.pointer.hover && state.pointer.hover->on_mesh ? PointerShape::hand : hand_over_landmarks(state);
}

PointerShape hand_over_landmarks(const EditorState& state) {
  if (state.pointer.drag) return PointerShape::hand;
  return state.pointer.hover && !state.pointer.hover->landmark.empty() ? PointerShape::hand : PointerShape::arrow;
}

}  // namespace homolog
