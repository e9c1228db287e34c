#pragma once

#include <functional>

#include "core/base/progress.h"
#include "core/mesh/topology.h"

namespace homolog {

/// Maps a point near a surface (mm) onto it.
using Projection = std::function<Vec3(const Vec3&)>;

/// The same surface with vertices spread evenly: edges near `edge_mm`, triangles near equilateral, genus kept
/// [Botsch and Kobbelt 2004, A Remeshing Approach to Multiresolution Modeling]. Every vertex of the result lies where
/// `project` says. The mesh must be closed.
Mesh remesh(const Mesh& mesh, double edge_mm, const Projection& project);

/// The same with a number of vertices asked for, which the result has exactly where the topology allows (≥ 4; a
/// surface with handles needs more). A cancelled run gives some mesh of the surface.
Mesh remesh_to_count(const Mesh& mesh, int vertices, const Projection& project, Progress* progress = nullptr);

}  // namespace homolog
