#pragma once

#include <optional>
#include <vector>

#include "core/fit/boundary.h"
#include "core/mesh/surface_search.h"

namespace homolog {

/// Force targets s_i that a boundary gives a mesh, and the weight of each.
struct BoundaryPull {
  Points targets;         ///< n×3, LPS mm; where nothing pulls, the vertex itself
  VertexScalars weights;  ///< 0 (nothing is known here) … 1
  Points normals;         ///< n×3, outward: the boundary's at the target; of `nearest` only
};

/// Looks for force targets in both directions: from every vertex to the nearest point of the boundary that faces the
/// same way, and from samples of the boundary to the nearest place of the mesh that does, whose corners they pull. One
/// direction alone would miss the parts of the boundary that no vertex is near.
class BoundarySearch {
 public:
  /// `boundary` outlives the search; `vertices`: of the meshes to come, which decides the number of samples.
  BoundarySearch(const Boundary& boundary, Eigen::Index vertices);

  BoundaryPull pull(const Mesh& mesh);

  /// The nearest boundary point to each vertex that faces the same way and that the scan shows; the weight is 0 where
  /// there is none.
  BoundaryPull nearest(const Mesh& mesh);

 private:
  struct Sample {
    Vec3 position, normal;
    double area_mm2 = 0;
    SurfaceSearch::Nearest on_mesh;  ///< at the last call
  };
  Vec3 normal_at(const SurfacePoint& at) const;
  struct Counterpart {
    Vec3 position, normal;
  };
  std::optional<Counterpart> counterpart(const Vec3& p, const Vec3& normal, std::int32_t& likely_face) const;

  const Boundary& boundary_;
  SurfaceSearch search_;
  Points normals_;
  std::vector<Sample> samples_;
  double area_mm2_ = 0;
  std::optional<SurfaceSearch> mesh_;       ///< refitted from call to call
  std::vector<std::int32_t> likely_faces_;  ///< of the boundary, per vertex
};

}  // namespace homolog
