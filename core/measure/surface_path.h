#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/mesh/geometry/surface_search.h"

namespace homolog {

/// A way over a surface.
struct SurfacePath {
  std::vector<Vec3> points;  ///< mm, with its start and its end; straight within each face
  double length_mm = 0;
};

/// The shortest way over a surface from one point to another: found over points on the edges (three on each), then
/// pulled straight over the faces that it crosses. It is at most a few thousandths longer than the shortest. Errors:
/// the points lie on parts that do not hang together.
Result<SurfacePath> shortest_path(const Mesh& mesh, const SurfacePoint& from, const SurfacePoint& to);

}  // namespace homolog
