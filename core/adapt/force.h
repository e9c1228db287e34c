#pragma once

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The places to which a target draws the vertices of a mesh: force targets s_i of Eq. 2, and how far each is to be
/// trusted.
struct TargetPull {
  Points targets;         ///< n×3, LPS mm; where nothing pulls, the vertex itself
  VertexScalars weights;  ///< 0: nothing is known here; 1: as a place on the boundary; a named place may weigh more
  Points normals;         ///< n×3, outward: the target's there; of SurfaceTarget::nearest only
};

/// Weight of a force that is not known: the solver needs one. There the shape decides.
inline constexpr double least_weight = 0.01;

/// The forces of one solve of Eq. 3, in multiples of the least one.
struct Force {
  VertexScalars weights;  ///< n, each at least 1
  Points pulls;           ///< n×3: weight × target
};

/// The force of a pull; where it knows nothing, the least one.
inline Force force_of(const TargetPull& pull) {
  const VertexScalars weights = pull.weights.cwiseMax(least_weight) / least_weight;
  return {weights, weights.asDiagonal() * pull.targets};
}

}  // namespace homolog
