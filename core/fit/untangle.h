#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// Frees a mesh of turned triangles and of faces that meet: around each such place the shape is solved for anew without
/// forces, as the reference has it between what lies around, in growing patches until none is left. `reference`: the
/// template placed, n×3; `factors`: its stiffness factors. False where some are left.
bool untangle(Mesh& mesh, const Points& reference, const VertexScalars& factors);

/// `to`, with the way there from `from` shortened around triangles that it would turn over, but for those that are
/// turned at `from`; `from` itself where that does not help. `placed`: the template as placed; all n×3.
Points without_turning(const Topology& topology, const Points& placed, const Points& from, const Points& to);

}  // namespace homolog
