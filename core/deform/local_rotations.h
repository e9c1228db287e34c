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

/// How much `points` strain their reference: the as-rigid-as-possible energy of the edges, Σ ‖(p_i − p_j) −
/// R̂_i (r_i − r_j)‖², as a share of Σ ‖r_i − r_j‖² (no unit; 0 where each one-ring only turned). Both n×3.
double strain_share(const Topology& topology, const Points& reference, const Points& points);

}  // namespace homolog
