#include "app/editor/picking/shown_mesh.h"

#include <algorithm>
#include <limits>

#include "core/base/numbers/nearest_on_segment.h"

namespace homolog {

namespace {

/// Whether a ray meets a box: the slabs between its sides have a length of it in common.
bool meets(const Ray& ray, const Box& box) {
  double from = 0, to = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double along = ray.direction[axis], low = box.min()[axis] - ray.from[axis],
                 high = box.max()[axis] - ray.from[axis];
    if (along == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    from = std::max(from, std::min(low / along, high / along));
    to = std::min(to, std::max(low / along, high / along));
  }
  return from <= to;
}

}  // namespace

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
  Searched& one = searched_[shown.structure.id];
  if (one.topology != topology) one = {topology, nullptr, {}, std::nullopt, false};
  if (one.points != points) {
    one.points = points;
    one.box = bounds_of(*points);
    one.follows = false;
  }
  if (!meets(ray, one.box)) return std::nullopt;
  if (!one.surface)
    one.surface.emplace(Mesh{topology, *points});
  else if (!one.follows)
    one.surface->refit(*points);
  one.follows = true;
  const auto hit = one.surface->first_hit(ray.from, ray.direction);
  return hit ? std::optional<Vec3>(hit->position) : std::nullopt;
}

}  // namespace homolog
