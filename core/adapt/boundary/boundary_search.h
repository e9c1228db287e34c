#pragma once

#include <optional>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/adapt/force.h"
#include "core/mesh/surface_search.h"

namespace homolog {

/// Looks for force targets in both directions. Every vertex looks for the nearest boundary point that faces the same
/// way. Every sample of the boundary looks for the nearest place of the mesh that faces the same way, and pulls the
/// corners there. One direction alone would miss parts of the boundary that no vertex is near.
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
