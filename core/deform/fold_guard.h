#pragma once

#include <functional>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Faces of `points` whose normal is over 90° from their reference normal carried along by the fitted one-ring
/// rotations: the one definition of a turned triangle that the guard, the overlay and every report use. `reference`:
/// the template as placed, not warped.
std::vector<std::int32_t> turned_triangles(const Topology& topology, const Points& reference, const Points& points);

/// Keeps one gesture from turning a triangle or flattening it below a quality floor (4√3·area/Σ edge² ≥ 0.1, lowered to
/// half of the quality at the gesture's start where that is worse, so that a sliver never freezes the tool).
class FoldGuard {
 public:
  FoldGuard(const Topology& topology, const Points& reference, const Points& start);

  /// Prepares `largest_step` for the path start + t·response·dᵀ; O(faces).
  void set_response(const VertexScalars& response);
  /// The largest t in 0…1 for which the closed form guarantees: at start + t·response·dᵀ no triangle is turned against
  /// its normal carried to the gesture's start, and none falls below the floor. Closed form: along the path a
  /// triangle's normal is linear in t, since d × d = 0.
  double largest_step(const Vec3& d);

  /// Whether `points` (reached in any way) holds no triangle that is turned, by the definition above, or below its
  /// floor, other than those that were so at the start.
  bool accepts(const Points& points) const;
  /// The first of the steps `longest`, half of it, a quarter … whose points are accepted; 0 where none above a
  /// thousandth is. `at(step)` gives the points.
  double accepted_step(double longest, const std::function<Points(double)>& at) const;

 private:
  void collect_strained();

  const Topology& topology_;
  const Points& reference_;
  const Points& start_;
  Points carried_;  ///< per face: the reference normal carried to the start, unit; zero where turned already
  VertexScalars floor_;
  VertexScalars response_;
  /// The faces that a displacement of up to `reach_mm_` could bring to their limit; with it the condition at t = 1:
  /// c0 + slope·d − bend·|d|² ≥ 0.
  struct Strained {
    double c0, bend;
    Vec3 slope;
  };
  std::vector<Strained> strained_;
  double reach_mm_ = 0;
};

}  // namespace homolog
