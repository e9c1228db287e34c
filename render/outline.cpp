#include "render/outline.h"

#include <cassert>
#include <utility>

namespace homolog {
namespace {

EdgeCrossing cross(std::int32_t a, std::int32_t b, const Points& points, const Eigen::VectorXd& distance) {
  const auto [low, high] = std::minmax(a, b);
  const double share = distance[low] / (distance[low] - distance[high]);
  const Vec3 start = points.row(low), end = points.row(high);
  return {low, high, share, start + share * (end - start)};
}

}  // namespace

std::vector<OutlineSegment> intersect_plane(const Topology& topology, const Points& points, const Vec3& on_plane,
                                            const Vec3& normal) {
  assert(points.rows() == topology.vertices());
  const Eigen::VectorXd distance = points * normal - Eigen::VectorXd::Constant(points.rows(), normal.dot(on_plane));
  std::vector<std::uint8_t> above(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index i = 0; i < points.rows(); ++i) above[i] = distance[i] >= 0;

  std::vector<OutlineSegment> segments;
  const Triangles& triangles = topology.triangles();
  for (Eigen::Index face = 0; face < triangles.rows(); ++face) {
    const std::int32_t* corner = triangles.data() + 3 * face;
    const auto side = [&](int k) { return above[corner[k]]; };
    if (side(0) == side(1) && side(1) == side(2)) continue;
    // The corner alone on its side; both edges from it are cut.
    const int lone = side(1) == side(2) ? 0 : side(0) == side(2) ? 1 : 2;
    segments.push_back({static_cast<std::int32_t>(face), cross(corner[lone], corner[(lone + 1) % 3], points, distance),
                        cross(corner[lone], corner[(lone + 2) % 3], points, distance)});
  }
  return segments;
}

}  // namespace homolog
