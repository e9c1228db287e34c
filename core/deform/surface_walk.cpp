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
      station_{start, start.interpolate(topology, points).transpose()},
      now_(station_),
      cursor_(cursor) {}

SurfaceFollower::Place SurfaceFollower::followed(const Vec3& cursor, double step_mm) const {
  const auto nearest = walk_to_nearest(topology_, points_, station_.at, cursor);
  if ((nearest.position - station_.position).norm() > 3 * step_mm) return station_;  // the medial axis: held
  return {nearest.at, nearest.position};
}

void SurfaceFollower::move_to(const Vec3& cursor, double edge_mm) {
  // Stations lie on a grid far below any accuracy: how a straight path was divided leaves no trace in their last bits.
  constexpr double grid_per_mm = 1 << 20;
  constexpr int most_steps = 1000;
  const Vec3 way = cursor - cursor_;
  const double length = way.norm();
  if (!(length > 0) || !std::isfinite(length)) return;
  const double step_mm = std::max(edge_mm / 2, length / most_steps);
  double along = step_mm - beyond_mm_;
  if (along < -step_mm) along += std::floor(-along / step_mm) * step_mm;  // after a leap: they would all be at its end
  for (int step = 0; along <= length && step <= most_steps + 2; ++step, along += step_mm) {
    const Vec3 exact = cursor_ + way * (std::max(along, 0.0) / length);
    station_ = followed((exact * grid_per_mm).array().round().matrix() / grid_per_mm, step_mm);
  }
  beyond_mm_ = length - (along - step_mm);
  cursor_ = cursor;
  now_ = followed(cursor, step_mm);
}

}  // namespace homolog
