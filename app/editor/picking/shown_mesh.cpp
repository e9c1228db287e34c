#include "app/editor/picking/shown_mesh.h"

#include "core/base/nearest_on_segment.h"

namespace homolog {

std::optional<Vec3> ShownMesh::nearest_on_outline(const ShapeView& shown, const SliceView& slice, const Vec3& p_mm,
                                                  double radius_mm) const {
  const auto flat = [&](const Vec3& p) {
    return Eigen::Vector2d(slice.right.dot(p - slice.centre), slice.down.dot(p - slice.centre));
  };
  const Eigen::Vector2d wanted = flat(p_mm);
  const auto outline = outlines_->of(shown.the_template().topology, shown.shape.points, slice.centre, slice.normal());
  std::optional<Vec3> nearest;
  double smallest = radius_mm;
  for (const OutlineSegment& segment : *outline) {
    const Eigen::Vector2d from = flat(segment.from.point), to = flat(segment.to.point);
    const double share = nearest_on_segment(wanted, from, to);
    const double distance = (from + share * (to - from) - wanted).norm();
    if (distance > smallest) continue;
    smallest = distance;
    nearest = segment.from.point + share * (segment.to.point - segment.from.point);
  }
  return nearest;
}

std::optional<Vec3> ShownMesh::first_on_surface(const ShapeView& shown, const Ray& ray) {
  const auto& topology = shown.the_template().topology;
  const auto& points = shown.shape.points;
  if (!surface_ || topology_ != topology) {
    surface_.emplace(Mesh{topology, *points});
  } else if (points_ != points) {
    surface_->refit(*points);
  }
  topology_ = topology;
  points_ = points;
  const auto hit = surface_->first_hit(ray.from, ray.direction);
  return hit ? std::optional<Vec3>(hit->position) : std::nullopt;
}

}  // namespace homolog
