#include <algorithm>
#include <cmath>

#include "app/editor/state/icons.h"
#include "app/editor/update/tools/tool.h"
#include "core/base/text/in_quotes.h"

namespace homolog {

namespace {

/// Where a dab goes whose circle is drawn at a px; nullopt where it covers nothing of the mesh.
std::optional<Vec3> dab_at(const EditorState& state, const ControlsContext& context, const Pointing& at) {
  const auto& [map, x_px, y_px, scale] = at;
  const auto on_mesh = mesh_at(state, context, at, state.hand.brush.radius_mm);
  const bool fills = state.hand.tool == MouseTool::stiffness && state.hand.brush.paints == BrushPaints::fill;
  if (!on_mesh || fills || !map.is_slice()) return on_mesh;
  return map.on_facing_plane(x_px, y_px, state.look.crosshair_mm);
}

bool begin_brush(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!press.shape() || (!hover.on_mesh && press.in_space())) return false;
  if (paints_regions(state) && press.shape()->paint().regions->list.empty())
    return press.hold({{}, "There is no region to paint yet. Add one first (Template, Regions)."});
  press.stay_at_frame();
  state.pointer.drag = BrushDrag{.view = hover.view,
                                 .x_px = press.event.x_px,
                                 .y_px = press.event.y_px,
                                 .reversed = press.event.alt,
                                 .waits_until = press.event.seconds + double_click_seconds};
  if (const auto dab = first_dab(state, press.context)) press.out.preview(dab);
  return true;
}

void move_brush(const DragStep& step) {
  EditorState& state = step.state;
  auto& drag = std::get<BrushDrag>(*state.pointer.drag);
  if (drag.waits_until && step.event.seconds < *drag.waits_until &&
      std::hypot(step.event.x_px - drag.x_px, step.event.y_px - drag.y_px) < double_click_px)
    return;
  drag.waits_until.reset();
  paint_to(state, step.context, step.event.x_px, step.event.y_px, step.out);
}

constexpr const char* paint_hint = "Paint on the outline or on the surface.";

std::string stiffness_hint(const EditorState& state, const Document& shown) {
  if (!paints_regions(state)) return paint_hint;
  if (active_structure(state, shown)->paint.regions->list.empty())
    return "There is no region to paint yet. Add one first (Template, Regions).";
  if (state.hand.brush.erases) return "The brush takes vertices out of their region.";
  // As the brush does: the first one where none of that name is there.
  const auto& list = active_structure(state, shown)->paint.regions->list;
  const bool known =
      std::any_of(list.begin(), list.end(), [&](const Region& one) { return one.name == state.hand.brush.region; });
  const std::string region = in_quotes(known ? state.hand.brush.region : list.front().name);
  return state.hand.brush.paints == BrushPaints::fill ? "Click to fill " + region + "; Alt empties."
                                                      : "Paint " + region + "; Alt erases.";
}

std::string confirm_hint(const EditorState& state, const Document&) {
  return state.hand.brush.hold ? paint_hint : "Paint what strokes may move again.";
}

/// What both have in common. Every dab is an edit of its own, so that the drag has none.
constexpr ToolKind brush_kind(ToolKind kind) {
  kind.section = deform_section;
  kind.marks = ToolMarks::brush_circle;
  kind.follows_mesh = true;
  kind.begin = begin_brush;
  kind.move = move_brush;
  return kind;
}

}  // namespace

constinit const ToolKind stiffness_tool =
    brush_kind({.tool = MouseTool::stiffness,
                .name = "Stiffness",
                .log_name = "stiffness",
                .key = "B",
                .in_keys = "Stiffness brush",
                .glyph = icon::stiffness,
                .tip = "Stiffness brush (B): paint how stiff the surface is. Alt paints the factor 1",
                .hint = stiffness_hint});
constinit const ToolKind confirm_tool =
    brush_kind({.tool = MouseTool::confirm,
                .name = "Confirm",
                .log_name = "confirm",
                .key = "C",
                .in_keys = "Confirm",
                .glyph = icon::confirm,
                .tip = "Confirm (C): later edits do not move what you paint. Alt frees it",
                .ends_group = true,
                .hint = confirm_hint});

void paint_to(EditorState& state, const ControlsContext& context, double x_px, double y_px, Outbox& out) {
  constexpr double parts_of_px = 256;
  auto& drag = std::get<BrushDrag>(*state.pointer.drag);
  const ViewMap map = view_map(state, context.layout, context.document, drag.view);
  const bool fills = state.hand.tool == MouseTool::stiffness && state.hand.brush.paints == BrushPaints::fill;
  const Eigen::Vector2d from(drag.x_px, drag.y_px), to(x_px, y_px);
  const double length_px = (to - from).norm();
  double along_px = drag.to_next_px;
  for (; along_px <= length_px && !(fills && drag.painted);) {
    const Eigen::Vector2d exact = length_px > 0 ? Eigen::Vector2d(from + along_px / length_px * (to - from)) : from;
    const Eigen::Vector2d px = (exact * parts_of_px).array().round() / parts_of_px;
    const auto at = dab_at(state, context, {map, px.x(), px.y()});
    if (at) {
      out.apply(*brush_action(state, context.document, *at), drag.painted);
      drag.painted = true;
    }
    const double step_mm = state.hand.brush.radius_mm / 2;
    along_px += std::max(1.0, step_mm / map.mm_per_px(at ? *at : state.look.crosshair_mm));
  }
  drag.to_next_px = along_px - length_px;
  drag.x_px = x_px;
  drag.y_px = y_px;
}

std::optional<Action> first_dab(const EditorState& state, const ControlsContext& context) {
  const auto& drag = std::get<BrushDrag>(*state.pointer.drag);
  const ViewMap map = view_map(state, context.layout, context.document, drag.view);
  const auto at = dab_at(state, context, {map, drag.x_px, drag.y_px});
  return at ? brush_action(state, context.document, *at) : std::nullopt;
}

std::optional<Action> brush_action(const EditorState& state, const Document& document, const Vec3& at) {
  const auto* drag = state.pointer.drag ? std::get_if<BrushDrag>(&*state.pointer.drag) : nullptr;
  const bool reversed = drag != nullptr && drag->reversed;
  const BrushSettings& brush = state.hand.brush;
  if (state.hand.tool == MouseTool::stiffness) {
    const auto& regions = active_structure(state, document)->paint.regions->list;
    const bool known =
        std::any_of(regions.begin(), regions.end(), [&](const Region& one) { return one.name == brush.region; });
    const std::string chosen = known || regions.empty() ? brush.region : regions.front().name;
    const std::string region = reversed || brush.erases ? std::string() : chosen;
    switch (brush.paints) {
      case BrushPaints::factor:
        return PaintStiffness{at, brush.radius_mm,
                              active_structure(state, document)->paint.base * (reversed ? 1 : brush.stiffness_factor),
                              brush.soft};
      case BrushPaints::region:
        return PaintRegion{region, at, brush.radius_mm, brush.soft};
      case BrushPaints::smooth:
        return SmoothStiffness{at, brush.radius_mm, 0.5};
      case BrushPaints::fill:
        return FillRegion{region, at, brush.fill_by, brush.fill_tolerance_per_mm};
    }
  }
  if (state.hand.tool == MouseTool::confirm)
    return Confirm{at, state.hand.brush.radius_mm, state.hand.brush.hold != reversed};
  return std::nullopt;
}

}  // namespace homolog
