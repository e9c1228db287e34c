#pragma once

#include "core/adapt/boundary/surface_target.h"
#include "core/placement/known_matches.h"

namespace homolog {

/// How surely the rims of a mesh and of a boundary are known to belong to each other.
enum class RimsLie { near, on_each_other };

/// These, and where the rims of a mesh belong, if those of the target's surface count [SurfaceTarget::has_rims]. LPS
/// mm. `mesh`: from where the target's rims are looked for. `from`: the places that the matches start from, n×3.
KnownMatches with_rims(KnownMatches known, const Mesh& mesh, RimsLie rims_lie, const Points& from,
                       SurfaceTarget& target);

}  // namespace homolog
