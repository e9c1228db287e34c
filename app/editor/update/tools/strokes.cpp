#include "app/editor/state/icons.h"
#include "app/editor/update/results/assistance.h"
#include "app/editor/update/tools/tool.h"
#include "core/deform/stroke_kinds.h"

namespace homolog {

namespace {

bool begin_stroke(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!hover.on_mesh) return false;
  press.stay_at_frame();
  StrokeDrag drag;
  drag.view = hover.view;
  drag.stroke.tool = *kind_of(state.hand.tool).stroke;
  drag.stroke.at = drag.stroke.to = *hover.on_mesh;
  drag.stroke.sigma_mm = state.hand.sigma_mm();
  drag.stroke.through_space = state.hand.through_space;
  drag.stroke.strength = state.hand.relax_strength;
  drag.press_mm = press.map().on_facing_plane(press.event.x_px, press.event.y_px, *hover.on_mesh);
  state.pointer.drag = drag;
  return true;
}

void move_stroke(const DragStep& step) {
  auto& drag = std::get<StrokeDrag>(*step.state.pointer.drag);
  const Vec3 cursor = step.map(drag.view).on_facing_plane(step.event.x_px, step.event.y_px, drag.stroke.at);
  drag.stroke.to = drag.stroke.at + (cursor - drag.press_mm);
  drag.moved = drag.moved || cursor != drag.press_mm;
  if (drag.moved) step.out.preview(drag.stroke);
}

std::optional<Action> stroke_action(const EditorState& state) {
  const auto& drag = std::get<StrokeDrag>(*state.pointer.drag);
  return drag.moved ? std::optional<Action>(drag.stroke) : std::nullopt;
}

void follow_stroke(EditorState& state, const Action& action, const ControlsContext& context, Outbox& out) {
  const auto& stroke = std::get<Stroke>(action);
  state.preferences.hints.dragged = true;
  if (!kind_of_stroke(stroke.tool).moves_boundary) return let_shared_follow(context.document, context.structure, out);
  const auto shown = context.shape();
  if (shown && state.automatic.snap.with_strokes && context.document.scan.image)
    out.send(SnapMesh{snap_region(*shown, stroke), true});
  if (state.automatic.model_help > 0) out.send(CompleteByModel{});
  let_shared_follow(context.document, context.structure, out);
  if (state.automatic.keep_apart && context.document.structures.size() > 1) out.send(KeepApart{state.automatic.gap_mm});
}

std::string stroke_hint(const EditorState&, const Document&) {
  return "Drag the outline. Wheel: slices; while dragging: \xcf\x83.";
}

/// What the four have in common.
constexpr ToolKind stroke_kind(ToolKind kind) {
  kind.marks = ToolMarks::sigma_ring;
  kind.hint = stroke_hint;
  kind.begin = begin_stroke;
  kind.move = move_stroke;
  kind.action = stroke_action;
  kind.follow = follow_stroke;
  return kind;
}

}  // namespace

constinit const ToolKind pull_tool =
    stroke_kind({.tool = MouseTool::pull,
                 .name = "Pull",
                 .log_name = "pull",
                 .key = "P",
                 .in_keys = "Pull",
                 .glyph = icon::pull,
                 .tip = "Pull (P): drag the outline; the surface follows along its normal",
                 .stroke = Tool::pull});
constinit const ToolKind grab_tool = stroke_kind({.tool = MouseTool::grab,
                                                  .name = "Grab",
                                                  .log_name = "grab",
                                                  .key = "G",
                                                  .in_keys = "Grab",
                                                  .glyph = icon::grab,
                                                  .tip = "Grab (G): drag a feature with its vertices",
                                                  .stroke = Tool::grab});
constinit const ToolKind slide_tool =
    stroke_kind({.tool = MouseTool::slide,
                 .name = "Slide",
                 .log_name = "slide",
                 .key = "S",
                 .in_keys = "Slide",
                 .glyph = icon::slide,
                 .tip = "Slide (S): move vertices along the surface; the surface stays",
                 .stroke = Tool::slide});
constinit const ToolKind relax_tool =
    stroke_kind({.tool = MouseTool::relax,
                 .name = "Relax",
                 .log_name = "relax",
                 .key = "R",
                 .in_keys = "Relax",
                 .glyph = icon::relax,
                 .tip = "Relax (R): drag to bring back the template's shape where you press",
                 .ends_group = true,
                 .stroke = Tool::relax});

}  // namespace homolog
