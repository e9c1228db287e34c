#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/adapt/target.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/parts/rims.h"

namespace homolog {

/// The surface of a label or of a mesh as a target. It looks in both directions. Every vertex looks for the nearest
/// boundary point that faces the same way. Every sample of the boundary looks for the nearest place of the mesh that
/// faces the same way, and pulls the corners there. One direction alone would miss parts of the boundary that no vertex
/// is near. If both the mesh and the surface have a rim [rims.h], rims belong to rims: a vertex of the one looks for
/// the nearest place of the other alone, and samples along the surface's rim pull the mesh's. Nothing else is drawn to
/// a rim, so that what one surface has beyond the other's rim does not count.
class SurfaceTarget : public Target {
 public:
  /// `boundary` outlives the target; `vertices`: of the meshes to come, which decides the number of samples.
  /// `lacks_parts`: parts of the organ may be missing [may_lack_parts]; the surface may end there, so no rim counts.
  SurfaceTarget(const Boundary& boundary, Eigen::Index vertices, bool lacks_parts = false);

  const Boundary& boundary() const { return boundary_; }
  const Mesh& surface() const { return boundary_.surface; }
  /// Whether the surface has rims that those of a mesh belong to.
  bool has_rims() const { return !rims_.empty(); }

  /// Once parts may be missing, counterparts must lie the nearer the larger `share` is.
  TargetPull pull(const Mesh& mesh, double share) override;
  /// The nearest boundary point to each vertex that faces the same way and that the scan shows; the weight is 0 where
  /// there is none.
  TargetPull nearest(const Mesh& mesh) override;
  /// The root of the surface's area.
  double size_mm() const override { return size_mm_; }
  /// From now on counterparts do not count where they lie farther apart than a share of the organ, on the rim of an
  /// opening, or on a face that is a cut.
  void may_lack_parts(double organ_mm) override { organ_mm_ = organ_mm; }

  /// Counterparts that lie farther apart than this do not count, up to the next pull.
  void set_reach_mm(double reach_mm) { reach_mm_ = reach_mm; }
  /// How near counterparts lie in the end, as a share of the diagonal of an organ that may lack parts.
  static constexpr double closest_reach = 0.015;

  /// The vertices without a counterpart, in rising order. A vertex goes with most of its neighbours, so that single
  /// ones do not count. Empty where hardly any are left.
  std::vector<std::int32_t> missing(const Mesh& mesh);

 private:
  struct Sample {
    Vec3 position, normal;
    double area_mm2 = 0;
    SurfaceSearch::Nearest on_mesh;  ///< the nearest place of the mesh at the last call
  };
  bool partial() const { return std::isfinite(reach_mm_); }
  Vec3 normal_at(const SurfacePoint& at) const;
  /// Before a mesh is looked at: which of its vertices belong to the rim. They stay the same from call to call.
  void know_rims(const Mesh& mesh);
  bool rims_count() const { return !mesh_rims_.empty(); }
  bool on_mesh_rim(Eigen::Index i) const { return rims_count() && on_mesh_rim_[i] != 0; }
  void nearest_on_rim(const Mesh& mesh, TargetPull& pull) const;
  void pull_rims(const Mesh& mesh, Points& sum, VertexScalars& weights) const;
  struct Counterpart {
    Vec3 position, normal;
  };
  std::optional<Counterpart> counterpart(const Vec3& p, const Vec3& normal, std::int32_t& likely_face) const;

  const Boundary& boundary_;
  SurfaceSearch search_;
  Points normals_;
  std::vector<Sample> samples_;
  double size_mm_, area_mm2_ = 0;
  double organ_mm_ = std::numeric_limits<double>::infinity(), reach_mm_ = std::numeric_limits<double>::infinity();
  std::optional<SurfaceSearch> mesh_;       ///< refitted from call to call
  std::vector<std::int32_t> likely_faces_;  ///< the boundary's face that is likeliest for each vertex
  std::vector<Rim> rims_;                   ///< the boundary's rims
  bool knows_rims_ = false;
  std::vector<Rim> mesh_rims_;                    ///< the meshes' rims; empty where rims do not count
  std::vector<std::vector<double>> rim_rest_mm_;  ///< the edges of each on the first mesh, which is the template's
  std::vector<char> on_mesh_rim_;                 ///< per vertex
};

}  // namespace homolog
