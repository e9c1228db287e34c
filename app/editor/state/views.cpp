#include "app/editor/state/views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/editor/state/view_colours.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

SliceView slice_view(const EditorState& state, ViewKind kind, const VolumeGeometry& geometry) {
  const auto [right, down] =
      screen_axes(kind, slice_axes(geometry, state.look.own_planes), state.preferences.radiological);
  const SlicePan& pan = state.look.slices[index_of(kind)];
  SliceView view;
  view.right = right;
  view.down = down;
  const Vec3 normal = view.normal();
  view.centre = pan.centre_mm + normal * normal.dot(state.look.crosshair_mm - pan.centre_mm);
  view.mm_per_px = pan.mm_per_px;
  return view;
}

VolumeGeometry geometry_of(const Document& document) {
  if (document.scan.image) return document.scan.image->geometry;
  VolumeGeometry geometry;
  Box box;
  for (const auto& structure : document.structures)
    if (const Shape* shape = structure->shape(document.frame)) box.extend(bounds_of(*shape->points));
  if (box.isEmpty()) box = Box(Vec3(-50, -50, -50), Vec3(50, 50, 50));
  const Vec3 margin = 0.25 * box.sizes();
  geometry.origin_mm = box.min() - margin;
  for (int axis = 0; axis < 3; ++axis)
    geometry.dims[axis] = std::max(1, static_cast<int>(std::lround(1.5 * box.sizes()[axis])));
  return geometry;
}

namespace {

/// Half of how far the grid reaches along a unit direction, from its middle.
double reach_mm(const VolumeGeometry& geometry, const Vec3& direction) {
  double reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double length_mm = geometry.dims[axis] * geometry.spacing_mm[axis];
    reach += std::abs(direction.dot(geometry.direction.col(axis))) * length_mm / 2;
  }
  return reach;
}

}  // namespace

ShownParts with_next_planes(ShownParts parts) {
  if (!parts.planes) {
    parts.planes = true;
    parts.plane_look = PlaneLook::translucent;
  } else if (parts.plane_look == PlaneLook::solid) {
    parts.planes = false;
  } else {
    parts.plane_look = static_cast<PlaneLook>(static_cast<int>(parts.plane_look) + 1);
  }
  return parts;
}

void zoom_slice(EditorState& state, ViewKind kind, double mm_per_px) {
  constexpr double smallest = 0.005, largest = 20;
  SlicePan& pan = state.look.slices[index_of(kind)];
  const double ratio = std::clamp(mm_per_px, smallest, largest) / pan.mm_per_px;
  pan.mm_per_px *= ratio;
  if (!state.preferences.linked_zoom) return;
  for (const ViewKind other : slice_views) {
    if (other == kind) continue;
    SlicePan& linked = state.look.slices[index_of(other)];
    linked.mm_per_px *= ratio;
    linked.centre_mm = state.look.crosshair_mm + ratio * (linked.centre_mm - state.look.crosshair_mm);
  }
}

void link_zoom(EditorState& state, bool linked) {
  state.preferences.linked_zoom = linked;
  if (!linked) return;
  double largest = 0;
  for (const SlicePan& pan : state.look.slices) largest = std::max(largest, pan.mm_per_px);
  for (SlicePan& pan : state.look.slices) pan.mm_per_px = largest;
}

std::vector<PlaneInSpace> shown_planes(const EditorState& state, const Document& document) {
  std::vector<PlaneInSpace> planes;
  if (!state.preferences.show.planes || !document.scan.image) return planes;
  const VolumeGeometry& geometry = document.scan.image->geometry;
  const Box box = geometry.bounds_mm();
  for (const ViewKind kind : slice_views) {
    PlaneInSpace plane;
    plane.plane = slice_view(state, kind, geometry);
    const Vec3 normal = plane.plane.normal();
    plane.plane.centre = box.center() + normal * normal.dot(state.look.crosshair_mm - box.center());
    plane.half_width_mm = reach_mm(geometry, plane.plane.right);
    plane.half_height_mm = reach_mm(geometry, plane.plane.down);
    plane.frame_colour = view_colour(kind);
    constexpr float seen_through = 0.4f;
    const PlaneLook look = state.preferences.show.plane_look;
    plane.opacity = look == PlaneLook::translucent ? seen_through : 1;
    plane.behind_meshes = look == PlaneLook::behind;
    planes.push_back(plane);
  }
  return planes;
}

void bring_into_view(EditorState& state, const Document& document) {
  const auto shown = active_shape(state, document);
  if (!shown) return;
  const Box box = bounds_of(*shown->shape.points);
  if (!box.contains(state.look.crosshair_mm)) {
    state.look.crosshair_mm = box.center();
    settle_crosshair(state, document);
  }
  constexpr double seen_share = 0.4;  // of the shorter side of a view, from its middle
  for (const ViewKind kind : slice_views) {
    SlicePan& pan = state.look.slices[index_of(kind)];
    const SliceView view = slice_view(state, kind, geometry_of(document));
    const Vec3 off = state.look.crosshair_mm - view.centre;
    const double reach_mm = seen_share * static_cast<double>(pan.side_px) * pan.mm_per_px;
    if (std::max(std::abs(off.dot(view.right)), std::abs(off.dot(view.down))) > reach_mm)
      pan.centre_mm = state.look.crosshair_mm;
  }
}

void look_at_mesh(EditorState& state, const Points& points) {
  const Box box = bounds_of(points);
  state.look.crosshair_mm = state.look.camera.target = box.center();
  state.look.camera.distance_mm = std::min(state.look.camera.distance_mm, 2.5 * box.diagonal().norm());
}

namespace {

/// How far off a camera sees all of a box, with a little room around it. `planes`: of a box of which only the three
/// planes through its middle are shown.
double distance_to_hold(const Camera3D& camera, const Box& box, bool planes) {
  constexpr double share_filled = 0.9;
  const double half_side = share_filled * std::tan(camera.fov_deg / 2 * std::numbers::pi / 180);
  const Vec3 right = camera.up.cross(camera.to_eye);
  double distance_mm = 1;
  const auto hold = [&](const Vec3& off) {
    const double aside = std::max(std::abs(off.dot(right)), std::abs(off.dot(camera.up)));
    distance_mm = std::max(distance_mm, off.dot(camera.to_eye) + aside / half_side);
  };
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner = box.corner(static_cast<Box::CornerType>(k)) - camera.target;
    if (!planes) hold(corner);
    for (int axis = 0; planes && axis < 3; ++axis) hold(corner - corner[axis] * Vec3::Unit(axis));
  }
  return distance_mm;
}

}  // namespace

void show_all(EditorState& state, const Document& document, const Layout& layout) {
  const VolumeGeometry geometry = geometry_of(document);
  const Box box = geometry.bounds_mm();
  for (const ViewKind kind : slice_views) {
    const auto [right, down] =
        screen_axes(kind, slice_axes(geometry, state.look.own_planes), state.preferences.radiological);
    const RectPx& rect = layout.image(kind);
    if (rect.width <= 0 || rect.height <= 0) continue;
    const double half_width_mm = reach_mm(geometry, right), half_height_mm = reach_mm(geometry, down);
    SlicePan& pan = state.look.slices[index_of(kind)];
    pan.centre_mm = box.center();
    pan.side_px = std::min(rect.width, rect.height);
    pan.mm_per_px = 2.04 * std::max(half_width_mm / rect.width, half_height_mm / rect.height);
  }
  link_zoom(state, state.preferences.linked_zoom);
  const auto shown = active_shape(state, document);
  Box target;
  for (const auto& structure : document.structures)
    if (const Shape* shape = structure->shape(document.frame)) target.extend(bounds_of(*shape->points));
  if (target.isEmpty()) target = box;
  // From the front, a little from the patient's left and from above: the planes do not hide each other.
  constexpr double left_px = 70, up_px = 45;
  state.look.camera = turned(camera_from(LookFrom::anterior, target), -left_px, up_px);
  // A mesh leaves some room for the planes around it.
  if (shown && document.scan.image)
    state.look.camera.distance_mm *= document.structures.size() > 1 ? 1.1 : 1.5;
  else
    state.look.camera.distance_mm = distance_to_hold(state.look.camera, target, document.scan.image != nullptr);
}

void look_at_step(EditorState& state) {
  if (!state.guide || !state.guide->shown || state.guide->at >= state.guide->steps.size()) return;
  const GuideStep& step = state.guide->steps[state.guide->at];
  state.look.crosshair_mm = step.to_mm;
  state.pointer.hover.reset();
  if (state.look.maximised) state.look.maximised = step.view;
  // A view that was moved off the place comes back to it.
  SlicePan& pan = state.look.slices[index_of(step.view)];
  constexpr double share_seen = 0.4;
  if ((step.to_mm - pan.centre_mm).norm() > share_seen * pan.side_px * pan.mm_per_px) pan.centre_mm = step.to_mm;
}

void look_closely(EditorState& state, const Mesh& mesh, std::int32_t vertex) {
  if (vertex < 0 || vertex >= mesh.points.rows()) return;
  const double near_mm = 1.2 * bounds_of(mesh.points).diagonal().norm();
  const Vec3 at = mesh.points.row(vertex);
  state.look.crosshair_mm = state.look.camera.target = at;
  state.look.camera.distance_mm = std::min(state.look.camera.distance_mm, near_mm);
  look_from_outside(state.look.camera, vertex_normals(mesh).row(vertex));
  for (SlicePan& pan : state.look.slices) pan.centre_mm = at;
}

void follow_layout(EditorState& state, const Layout& layout) {
  for (const ViewKind kind : slice_views) {
    const float side_px = std::min(layout.image(kind).width, layout.image(kind).height);
    if (side_px < 1) continue;
    SlicePan& pan = state.look.slices[index_of(kind)];
    if (pan.side_px > 0) pan.mm_per_px *= static_cast<double>(pan.side_px) / static_cast<double>(side_px);
    pan.side_px = side_px;
  }
}

void scroll_slice(EditorState& state, ViewKind kind, const Document& document, double steps) {
  state.look.scrolled += steps;
  const double whole_steps = std::trunc(state.look.scrolled);
  state.look.scrolled -= whole_steps;
  if (whole_steps == 0) return;
  // Away from the radiological viewer (axial: towards the head), whichever side is shown on the left.
  const VolumeGeometry geometry = geometry_of(document);
  const Vec3 normal = screen_axes(kind, slice_axes(geometry, state.look.own_planes), true).normal();
  const Box box = geometry.bounds_mm();
  // From the middle of the first voxel along the normal to that of the last; across it the cross-hair stays.
  const double step_mm = slice_step_mm(geometry, normal);
  const double reach = std::max(0.0, reach_mm(geometry, normal) - step_mm / 2);
  const double middle = normal.dot(box.center()), along = normal.dot(state.look.crosshair_mm);
  state.look.crosshair_mm +=
      normal * (std::clamp(along + whole_steps * step_mm, middle - reach, middle + reach) - along);
  settle_crosshair(state, document);
}

void settle_crosshair(EditorState& state, const Document& document) {
  if (!document.scan.image) return;
  const VolumeGeometry& geometry = document.scan.image->geometry;
  if (is_oblique(geometry) && !state.look.own_planes) return;
  state.look.crosshair_mm = geometry.to_mm(geometry.to_voxel(state.look.crosshair_mm).array().round().matrix());
}

}  // namespace homolog
