#pragma once

#include <functional>

#include "core/mesh/topology.h"

namespace homolog {

/// The same surface with vertices spread evenly: edges near `edge_mm`, triangles near equilateral, genus kept
/// [Botsch and Kobbelt 2004, A Remeshing Approach to Multiresolution Modeling]. `project` maps a point near the
/// surface onto it; every vertex of the result lies where it says. The mesh must be closed.
Mesh remesh(const Mesh& mesh, double edge_mm, const std::function<Vec3(const Vec3&)>& project);

}  // namespace homolog
