#pragma once

#include "core/mesh/surface_search.h"

namespace homolog {

/// The point nearest to `x` that a descent over neighbouring faces reaches from `from`: follows the surface
/// continuously and never jumps to another part of it, as a global search would.
SurfaceSearch::Nearest walk_to_nearest(const Topology& topology, const Points& points, const SurfacePoint& from,
                                       const Vec3& x);

/// Follows the cursor over the gesture-start surface for Pull: the nearest point, continuously, held where it would
/// move more than three times as far as the cursor (the medial axis, a thin pole).
class SurfaceFollower {
 public:
  SurfaceFollower(const Topology& topology, const Points& points, const SurfacePoint& start, const Vec3& cursor);
  /// Moves the cursor on a straight line to `cursor`, in steps of at most half of `edge_mm`.
  void move_to(const Vec3& cursor, double edge_mm);
  const SurfacePoint& at() const { return at_; }
  const Vec3& position() const { return position_; }

 private:
  void step(const Vec3& cursor);
  const Topology& topology_;
  const Points& points_;
  SurfacePoint at_;
  Vec3 position_;
  Vec3 cursor_;
};

}  // namespace homolog
