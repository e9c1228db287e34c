#include <cmath>

#include "app/editor/state/icons.h"
#include "app/editor/update/tools/tool.h"
#include "core/volume/redrawn_contour.h"

namespace homolog {

namespace {

constexpr double step_px = 3, closing_px = contour_reach_units, wide_px = 4 * closing_px;
constexpr std::size_t fewest_points = 8;  ///< of a curve: fewer are a click

/// As a line of the case writes it.
Vec3 in_micrometres(const Vec3& p_mm) {
  constexpr double per_mm = 1000;
  return (p_mm * per_mm).array().round() / per_mm;
}

/// `on_plane`: a point of the slice.
Vec3 place_on_slice(const ViewMap& map, const Vec3& on_plane, double x_px, double y_px) {
  return in_micrometres(map.on_facing_plane(x_px, y_px, on_plane));
}

bool begin_contour(const Press& press) {
  if (press.in_space() || !press.shape()) return false;
  press.stay_at_frame();
  ContourDrag drag;
  drag.view = press.hover.view;
  drag.id = free_contour_id(press.document());
  drag.x_px = press.event.x_px;
  drag.y_px = press.event.y_px;
  const ViewMap map = press.map();
  drag.points = {place_on_slice(map, press.state.look.crosshair_mm, drag.x_px, drag.y_px)};
  drag.held = contour_at({map, drag.x_px, drag.y_px, press.context.layout.scale}, press.document(),
                         press.shape()->structure, press.state.look.hidden_contours);
  press.state.pointer.drag = std::move(drag);
  return true;
}

/// The held contour with the part that the stroke drew anew; none where the stroke goes elsewhere.
std::optional<Action> redrawn(const ContourDrag& drag) {
  if (!drag.held) return std::nullopt;
  // A stroke around something that ends where it began is a curve of its own; a small one mends the contour.
  if (drag.at_start && drag.is_wide) return std::nullopt;
  std::vector<Vec3> stroke = drag.points;
  for (Vec3& p : stroke) p = in_micrometres(p + drag.held->aside);
  auto curve = redrawn_contour(drag.held->curve, stroke, drag.held->near_mm);
  if (!curve) return std::nullopt;
  for (Vec3& p : curve->points) p = in_micrometres(p);
  return SetContours{.id = drag.held->id,
                     .curves = std::make_shared<const std::vector<Contour>>(1, std::move(*curve)),
                     .curve = drag.held->number};
}

std::optional<Action> contour_action(const EditorState& state) {
  const auto& drag = std::get<ContourDrag>(*state.pointer.drag);
  if (drag.points.size() < fewest_points) return std::nullopt;
  if (auto action = redrawn(drag)) return action;
  auto curves = std::make_shared<const std::vector<Contour>>(
      std::vector<Contour>{{.points = drag.points, .closed = drag.at_start}});
  return SetContours{.id = drag.id, .name = "Contour " + drag.id.substr(1), .curves = std::move(curves)};
}

void move_contour(const DragStep& step) {
  auto& drag = std::get<ContourDrag>(*step.state.pointer.drag);
  const double x_px = step.event.x_px, y_px = step.event.y_px, scale = step.context.layout.scale;
  if (std::hypot(x_px - drag.x_px, y_px - drag.y_px) < step_px * scale) return;
  const ViewMap map = step.map(drag.view);
  drag.points.push_back(place_on_slice(map, drag.points.front(), x_px, y_px));
  drag.x_px = x_px;
  drag.y_px = y_px;
  const auto start_px = map.to_px(drag.points.front());
  const double from_start_px = start_px ? std::hypot(x_px - start_px->x(), y_px - start_px->y()) : 0;
  drag.is_wide = drag.is_wide || from_start_px > wide_px * scale;
  drag.at_start = drag.points.size() >= fewest_points && start_px && from_start_px < closing_px * scale;
  if (auto action = contour_action(step.state)) step.out.preview(std::move(action));
}

void follow_contour(EditorState& state, const Action&, const ControlsContext& context, Outbox& out) {
  state.wanted_section = contours_section;
  ++state.section_wanted;
  out.send(FitContours{true});
  let_shared_follow(context.document, context.structure, out);
}

std::string contour_hint(const EditorState&, const Document&) {
  return "Draw around the organ in a slice, or a part of a contour anew. With Ctrl any tool draws.";
}

}  // namespace

constinit const ToolKind contour_tool{.tool = MouseTool::contour,
                                      .name = "Contour",
                                      .log_name = "contour",
                                      .key = "A",
                                      .in_keys = "Contour",
                                      .glyph = icon::contour,
                                      .tip =
                                          "Contour (A, or Ctrl held with any tool): draw a curve in a slice; the mesh "
                                          "goes to it. From a contour back to it: that part anew",
                                      .section = contours_section,
                                      .cursor = [](const EditorState&) { return PointerShape::arrow; },
                                      .hint = contour_hint,
                                      .edits_at = [](const Hover& hover) { return hover.view != ViewKind::space; },
                                      .begin = begin_contour,
                                      .move = move_contour,
                                      .action = contour_action,
                                      .follow = follow_contour};

}  // namespace homolog
