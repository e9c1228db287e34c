#pragma once

#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Per vertex the proper rotation R̂_i that best carries the one-ring edges of `reference` to those of `points`
/// (as-rigid-as-possible: least squares over r_i − r_j ↦ p_i − p_j). Both n×3.
std::vector<Mat3> local_rotations(const Topology& topology, const Points& reference, const Points& points);

/// b_i = Σ_j (w_i R̂_i + w_j R̂_j)(r_i − r_j): the right-hand side that stands for Λ R when the reference turns with the
/// shape; equals Λ R when all rotations are the identity (docs/method.md, Spacing).
Points rotated_reference_force(const Topology& topology, const VertexScalars& w, const Points& reference,
                               const std::vector<Mat3>& rotations);

}  // namespace homolog
