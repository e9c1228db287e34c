#pragma once

#include "core/base/result.h"
#include "core/mesh/topology.h"

namespace homolog {

// Functions that a program calls first check what they are given by these. What they call in turn trusts it.

/// `what` names the thing in the sentence: "the surface". Errors: not `vertices` rows; a coordinate that is not finite.
Result<void> check_points(const Points& points, Eigen::Index vertices, const char* what);
/// The number of values alone. Errors: not `vertices` values.
Result<void> check_count(Eigen::Index values, Eigen::Index vertices, const char* what);
/// Errors: no topology; those of check_points.
Result<void> check_mesh(const Mesh& mesh, const char* what);

}  // namespace homolog
