#include "app/editor/picking/picking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/editor/state/state.h"
#include "app/editor/state/views.h"
#include "core/volume/redrawn_contour.h"

namespace homolog {

namespace {

constexpr double handle_reach_units = 9, landmark_reach_units = 10;

}  // namespace

ViewMap::ViewMap(const RectPx& rect, const SliceView& slice) : rect_(rect), is_slice_(true), slice_(slice) {}
ViewMap::ViewMap(const RectPx& rect, const Camera3D& camera) : rect_(rect), is_slice_(false), camera_(camera) {}

Viewport ViewMap::target() const {
  Viewport target;
  target.width = static_cast<int>(rect_.width);
  target.height = static_cast<int>(rect_.height);
  return target;
}

std::optional<Eigen::Vector2d> ViewMap::to_px(const Vec3& p_mm) const {
  const Eigen::Vector2d corner(rect_.x, rect_.y);
  if (is_slice_) return corner + slice_point_px(slice_, target(), p_mm);
  const Vec3 px = camera_point_px(camera_, target(), p_mm);
  if (px.z() <= 0) return std::nullopt;
  return corner + px.head<2>();
}

Ray ViewMap::ray(double x_px, double y_px) const {
  if (is_slice_) return {slice_point_mm(slice_, target(), x_px - rect_.x, y_px - rect_.y), slice_.normal()};
  return camera_ray(camera_, target(), x_px - rect_.x, y_px - rect_.y);
}

Vec3 ViewMap::on_facing_plane(double x_px, double y_px, const Vec3& on_plane) const {
  const Ray line = ray(x_px, y_px);
  if (is_slice_) return line.from;
  const Vec3 normal = into_screen();
  return line.from + line.direction * (normal.dot(on_plane - line.from) / normal.dot(line.direction));
}

Vec3 ViewMap::into_screen() const {
  return is_slice_ ? slice_.normal() : Vec3(-camera_.to_eye.normalized());
}

Vec3 ViewMap::right() const {
  return is_slice_ ? slice_.right : camera_right(camera_);
}

double ViewMap::mm_per_px(const Vec3& at) const {
  if (is_slice_) return slice_.mm_per_px;
  const double at_target = camera_mm_per_px(camera_, std::min(rect_.width, rect_.height));
  const double depth = camera_.distance_mm + into_screen().dot(at - camera_.target);
  return at_target * depth / camera_.distance_mm;
}

bool hidden_by_planes(const std::vector<PlaneInSpace>& planes, const VolumeGeometry& image, const Ray& ray,
                      const Vec3& p_mm) {
  const double reach = ray.direction.dot(p_mm - ray.from) / ray.direction.squaredNorm();
  return std::any_of(planes.begin(), planes.end(), [&](const PlaneInSpace& part) {
    if (part.opacity < 1 || part.behind_meshes) return false;
    const Vec3 normal = part.plane.normal();
    const double facing = normal.dot(ray.direction);
    if (std::abs(facing) < 1e-9) return false;
    const double along = normal.dot(part.plane.centre - ray.from) / facing;
    if (along <= 0 || along > reach * (1 - 1e-6)) return false;
    const Vec3 voxel = image.to_voxel(ray.from + along * ray.direction);
    const Vec3 last(image.dims[0], image.dims[1], image.dims[2]);
    return (voxel.array() > -0.5).all() && (voxel.array() < last.array() - 0.5).all();
  });
}

std::optional<PlacementHandles> placement_handles(const ViewMap& map, const Points& points, float scale) {
  PlacementHandles handles;
  handles.centre_mm = bounds_of(points).center();
  const auto centre = map.to_px(handles.centre_mm);
  if (!centre) return std::nullopt;
  handles.centre_px = *centre;
  double reach_mm = 0;
  const Vec3 normal = map.into_screen();
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Vec3 arm = points.row(i).transpose() - handles.centre_mm;
    reach_mm = std::max(reach_mm, (arm - normal * normal.dot(arm)).squaredNorm());
  }
  handles.radius_px = std::sqrt(reach_mm) / map.mm_per_px(handles.centre_mm) + 16 * scale;
  const double diagonal = std::numbers::sqrt2 / 2;
  handles.knob_px = handles.centre_px + handles.radius_px * Eigen::Vector2d(diagonal, diagonal);
  return handles;
}

PlacePart part_at(const PlacementHandles& handles, double x_px, double y_px, float scale) {
  const Eigen::Vector2d pointer(x_px, y_px);
  const double reach = handle_reach_units * scale;
  if ((pointer - handles.knob_px).norm() < reach) return PlacePart::knob;
  const double from_centre = (pointer - handles.centre_px).norm();
  if (std::abs(from_centre - handles.radius_px) < reach) return PlacePart::ring;
  return from_centre < handles.radius_px ? PlacePart::body : PlacePart::none;
}

Similarity dragged_placement(const PlaceDrag& drag, const ViewMap& map, double x_px, double y_px) {
  const Vec3 now = map.on_facing_plane(x_px, y_px, drag.centre_mm);
  const Vec3 normal = map.into_screen();
  const auto arm_to = [&](const Vec3& p) {
    const Vec3 arm = p - drag.centre_mm;
    return Vec3(arm - normal * normal.dot(arm));
  };
  const Vec3 from = arm_to(drag.press_mm), to = arm_to(now);
  Similarity change;
  switch (drag.part) {
    case PlacePart::none:
      break;
    case PlacePart::body:
      change.translation = now - drag.press_mm;
      break;
    case PlacePart::ring: {
      const double angle = std::atan2(normal.dot(from.cross(to)), from.dot(to));
      change.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, normal));
      change.translation = drag.centre_mm - change.rotation * drag.centre_mm;
      break;
    }
    case PlacePart::knob: {
      change.scale = std::clamp(from.norm() > 0 ? to.norm() / from.norm() : 1, 0.05, 20.0);
      change.translation = (1 - change.scale) * drag.centre_mm;
      break;
    }
  }
  return change.after(drag.start);
}

std::string landmark_at(const Pointing& at, const std::map<std::string, Vec3>& landmarks, double slice_reach_mm) {
  const auto& [map, x_px, y_px, scale] = at;
  std::string nearest;
  double smallest = landmark_reach_units * scale;
  for (const auto& [name, p_mm] : landmarks) {
    if (map.is_slice() && std::abs(map.into_screen().dot(p_mm - map.slice().centre)) > slice_reach_mm) continue;
    const auto px = map.to_px(p_mm);
    if (!px) continue;
    const double distance = (*px - Eigen::Vector2d(x_px, y_px)).norm();
    if (distance >= smallest) continue;
    smallest = distance;
    nearest = name;
  }
  return nearest;
}

bool lies_in_slice(const ViewMap& map, const Contour& curve, const VolumeGeometry& geometry) {
  if (!map.is_slice()) return false;
  const Vec3 normal = map.into_screen();
  const double reach_mm = slice_step_mm(geometry, normal) / 2;
  return std::ranges::all_of(curve.points,
                             [&](const Vec3& p) { return std::abs(normal.dot(p - map.slice().centre)) <= reach_mm; });
}

std::optional<HeldContour> contour_at(const Pointing& pointing, const Document& document, const Structure& structure,
                                      const std::set<std::string>& hidden) {
  const auto& [map, x_px, y_px, scale] = pointing;
  if (!map.is_slice()) return std::nullopt;
  const Vec3 normal = map.into_screen(), pointer = map.on_facing_plane(x_px, y_px, map.slice().centre);
  const double near_mm = contour_reach_units * scale * map.mm_per_px(pointer);
  double smallest = near_mm;
  std::optional<HeldContour> held;
  for (const auto& set : structure.contours) {
    if (set->frame != document.frame || hidden.contains(set->id)) continue;
    for (std::size_t c = 0; c < set->curves.size(); ++c) {
      const Contour& curve = set->curves[c];
      if (!lies_in_slice(map, curve, geometry_of(document))) continue;
      const Vec3 at = nearest_place(curve, pointer).at, way = at - pointer, aside = normal * normal.dot(way);
      const double distance = (way - aside).norm();
      if (distance > smallest) continue;
      smallest = distance;
      held = HeldContour{set->id, static_cast<int>(c), curve, at, aside, near_mm};
    }
  }
  return held;
}

}  // namespace homolog
