#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// Frees a mesh of turned triangles and of faces that pass through each other. Around each such place a patch is solved
/// again without forces, so that it takes the reference's shape between its surroundings. Patches grow until no fault
/// is left. `reference`: the template placed, n×3; `factors`: its stiffness factors. False where some are left.
bool untangle(Mesh& mesh, const Points& reference, const VertexScalars& factors);

/// The points on the way from `from` to `to`, as far as no triangle turns over that is not turned at `from` already.
/// The way is shortened only around such triangles. If that does not help, the result is `from`. `placed`: the template
/// as placed; all n×3.
Points without_turning(const Topology& topology, const Points& placed, const Points& from, const Points& to);

}  // namespace homolog
