#include "core/adapt/match/facing_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/numbers/rotation.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

using Eigen::Index;

constexpr Index samples_a_vertex = 2, regions = 60;
constexpr double region_share = 0.3;  ///< share of the radius: how far a region reaches
/// Shares of the root of the surface's area: how far a place may be off; what slides as one.
constexpr double near_share = 0.022, stiff_share = 0.044;
constexpr double smooth_of_near = 0.64;  ///< detail that directions leave out
constexpr double sharpness = 8;          ///< 1 over the angle, in radians, by which directions of the same place differ
constexpr double weight_of_known = 0.3, most_weight = 10;

/// How much the places around row `centre` of `points` belong to it: 1 … 0.
VertexScalars closeness(const Points& points, Index centre, double reach2_mm2) {
  return ((points.rowwise() - points.row(centre)).rowwise().squaredNorm().array() / (-2 * reach2_mm2)).exp();
}

/// `normals` (n×3) at `from` turned as the region around each turns on its way to `to`.
Points turned_by_region(const Points& normals, const Points& from, const Points& to) {
  const Eigen::RowVector3d centre = from.colwise().mean();
  const double reach2_mm2 = region_share * region_share * (from.rowwise() - centre).rowwise().squaredNorm().mean();
  Points turned = Points::Zero(normals.rows(), 3);
  for (const Index region : spread_vertices(from, regions)) {
    VertexScalars share = closeness(from, region, reach2_mm2);
    share /= share.sum();
    const Eigen::RowVector3d from_mean = share.transpose() * from, to_mean = share.transpose() * to;
    const Points from_weighed = share.asDiagonal() * (from.rowwise() - from_mean);
    const Mat3 turn = nearest_rotation((to.rowwise() - to_mean).transpose() * from_weighed);
    turned += closeness(from, region, reach2_mm2 / 2).asDiagonal() * (normals * turn.transpose());
  }
  const VertexScalars lengths = turned.rowwise().norm().cwiseMax(std::numeric_limits<double>::min());
  return lengths.cwiseInverse().asDiagonal() * turned;
}

}  // namespace

FacingSearch::FacingSearch(const Mesh& surface, Index vertices)
    : size_mm_(std::sqrt(surface_area_mm2(surface))),
      there_(samples_of(surface, vertex_normals(surface),
                        stepped_vertices(surface.points.rows(), samples_a_vertex * vertices))) {
  // Coarse samples tell no finer place than their spacing.
  const auto coarser = static_cast<double>(std::min(vertices, there_.points.rows()));
  near_mm_ = size_mm_ * std::max(near_share, 1 / std::sqrt(coarser));
  there_.normals = smooth_normals(there_, smooth_of_near * near_mm_);
}

TargetPull FacingSearch::pull(const Mesh& placed, const Mesh& mesh) const {
  std::vector<Index> all(static_cast<std::size_t>(placed.points.rows()));
  std::iota(all.begin(), all.end(), 0);
  const SurfaceSamples own = samples_of(placed, vertex_normals(placed), std::move(all));
  Points normals(own.points.rows(), 3);
  normals(own.vertices, Eigen::all) = smooth_normals(own, smooth_of_near * near_mm_);
  const auto [targets, known] =
      located(mesh.points, turned_by_region(normals, placed.points, mesh.points), there_, near_mm_, sharpness);
  return {targets, (weight_of_known * known).cwiseMin(most_weight), {}};
}

double FacingSearch::stiffness_mm() const {
  return stiff_share * size_mm_;
}

}  // namespace homolog
