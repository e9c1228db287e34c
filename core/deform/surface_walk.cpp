#include "core/deform/surface_walk.h"

#include <algorithm>
#include <cmath>

namespace homolog {

namespace {

SurfaceSearch::Nearest nearest_in_face(const Topology& topology, const Points& points, std::int32_t face,
                                       const Vec3& x) {
  const auto t = topology.triangles().row(face);
  SurfaceSearch::Nearest nearest;
  nearest.at.face = face;
  nearest.at.weights = nearest_in_triangle(x, points.row(t[0]), points.row(t[1]), points.row(t[2]));
  nearest.position = nearest.at.interpolate(topology, points).transpose();
  nearest.distance_mm = (nearest.position - x).norm();
  return nearest;
}

}  // namespace

SurfaceSearch::Nearest walk_to_nearest(const Topology& topology, const Points& points, const SurfacePoint& from,
                                       const Vec3& x) {
  SurfaceSearch::Nearest best = nearest_in_face(topology, points, from.face, x);
  for (bool closer = true; closer;) {
    closer = false;
    const Eigen::RowVector3i corners = topology.triangles().row(best.at.face);
    for (int k = 0; k < 3; ++k) {
      for (const std::int32_t face : topology.faces_of(corners[k])) {
        const auto candidate = nearest_in_face(topology, points, face, x);
        if (candidate.distance_mm < best.distance_mm - 1e-12) {
          best = candidate;
          closer = true;
        }
      }
    }
  }
  return best;
}

SurfaceFollower::SurfaceFollower(const Topology& topology, const Points& points, const SurfacePoint& start,
                                 const Vec3& cursor)
    : topology_(topology),
      points_(points),
      at_(start),
      position_(start.interpolate(topology, points).transpose()),
      cursor_(cursor) {}

void SurfaceFollower::step(const Vec3& cursor) {
  const double cursor_moved = (cursor - cursor_).norm();
  cursor_ = cursor;
  const auto candidate = walk_to_nearest(topology_, points_, at_, cursor);
  if ((candidate.position - position_).norm() > 3 * cursor_moved + 1e-9) return;  // the medial axis: held
  at_ = candidate.at;
  position_ = candidate.position;
}

void SurfaceFollower::move_to(const Vec3& cursor, double edge_mm) {
  const Vec3 from = cursor_;
  const double length = (cursor - from).norm();
  if (length == 0) return;
  const int steps = static_cast<int>(std::clamp(std::ceil(2 * length / edge_mm), 1.0, 1000.0));
  for (int k = 1; k <= steps; ++k) step(from + (cursor - from) * (static_cast<double>(k) / steps));
}

}  // namespace homolog
