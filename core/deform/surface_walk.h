#pragma once

#include "core/mesh/geometry/surface_search.h"

namespace homolog {

/// The point nearest to `x` that a descent over neighbouring faces reaches from `from`: follows the surface
/// continuously and never jumps to another part of it, as a global search would.
SurfaceSearch::Nearest walk_to_nearest(const Topology& topology, const Points& points, const SurfacePoint& from,
                                       const Vec3& x);

/// Follows the cursor over the gesture-start surface for Pull: the nearest point, continuously, held where it would
/// move more than three times as far as the cursor (the medial axis, a thin pole). It is found anew at every half of
/// an edge along the cursor's path, so that it depends on the path and not on how many events told of it.
class SurfaceFollower {
 public:
  SurfaceFollower(const Topology& topology, const Points& points, const SurfacePoint& start, const Vec3& cursor);
  /// Moves the cursor on a straight line to `cursor`; `edge_mm` is the mean length of an edge.
  void move_to(const Vec3& cursor, double edge_mm);
  const SurfacePoint& at() const { return now_.at; }
  const Vec3& position() const { return now_.position; }

 private:
  struct Place {
    SurfacePoint at;
    Vec3 position;
  };
  Place followed(const Vec3& cursor, double step_mm) const;
  const Topology& topology_;
  const Points& points_;
  Place station_;  ///< the place at the last half of an edge along the path
  Place now_;      ///< the place reached from there towards the cursor
  Vec3 cursor_;
  double beyond_mm_ = 0;  ///< the path's length from the station to the cursor
};

}  // namespace homolog
