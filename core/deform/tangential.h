#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// The part of `offset` (n×3) in the tangent plane at each vertex; on an open mesh's boundary, the part along it.
Points tangential(const Mesh& mesh, const Points& offset);

/// The boundary vertices of `points` brought to the nearest place of the loop of `mesh` that they belong to.
Points on_rims(const Mesh& mesh, const Points& points);

/// The vertices moved by `offset`, then brought back onto the mesh's surface by a local search from each vertex (so
/// that it never jumps to another sheet); boundary vertices stay on their boundary loop.
Points slid_along_surface(const Mesh& mesh, const Points& offset);

}  // namespace homolog
