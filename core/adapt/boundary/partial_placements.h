#pragma once

#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog {

/// How many placements `placements_towards` gives, where it gives any.
constexpr std::size_t other_placements = 3;

/// If an end of an organ is missing, the placement tends to be too small and too near. These are others to try: each
/// is larger, or moved towards what is missing. The larger ones keep the place that is farthest from it.
/// `found`: the placement that `points` (the mesh, n×3, LPS mm) began with. `missing`: n, 1 where the boundary lacks
/// the organ, else 0. Empty where all or nothing is missing.
std::vector<Similarity> placements_towards(const Similarity& found, const Points& points, const VertexScalars& missing);

}  // namespace homolog
