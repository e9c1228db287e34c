#pragma once

#include <functional>

#include "core/base/processes/progress.h"
#include "core/mesh/topology.h"

namespace homolog {

/// Maps a point near a surface (mm) onto it.
using Projection = std::function<Vec3(const Vec3&)>;

/// Mean edge in mm of as many near-equilateral triangles as `vertices` on a closed surface of `area_mm2` have.
double spread_edge_mm(double area_mm2, Eigen::Index vertices);

/// The same surface with `vertices` spread evenly (≥ 4; exactly so many where the topology allows), triangles near
/// equilateral, genus kept [Botsch and Kobbelt 2004, A Remeshing Approach to Multiresolution Modeling]. Every vertex
/// lies where `project` says. Rims stay rims: their vertices are spread evenly along them and lie where `project_rim`
/// says; a closed mesh needs none. A cancelled run gives some mesh of the surface.
Mesh remesh_to_count(const Mesh& mesh, int vertices, const Projection& project, Progress* progress = nullptr,
                     const Projection& project_rim = {});

}  // namespace homolog
