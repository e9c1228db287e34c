#include "core/adapt/doubt/fit_doubt.h"

#include <cmath>
#include <limits>

#include "core/base/numbers/index.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// As shares of the root of the surface's area: at least, times the strain share, and where nothing tells. A match
/// follows small differences of shape. What it misses grows with the square of the strain, as the share does.
constexpr double least_doubt = 0.004, doubt_by_strain = 0.6, doubt_if_round = 0.024;
/// A share of the same root: what is missing counts as this much farther away, since how much is missing is a guess.
constexpr double farther_if_missing = 0.15;
constexpr double slides_share = 0.5;  ///< share of what holds everywhere, as squares: lies where vertices can slide

}  // namespace

VertexScalars fit_doubt_mm(const Mesh& mesh, const ReasonsForDoubt& reasons) {
  const Eigen::Array3d everywhere{least_doubt, doubt_by_strain * reasons.strain, doubt_if_round * reasons.roundness};
  const double area_mm2 = surface_area_mm2(mesh), farther_mm = farther_if_missing * std::sqrt(area_mm2);
  VertexScalars doubt_mm2 =
      reasons.spread_mm2.array() +
      everywhere.square().sum() * area_mm2 * (1 - slides_share + slides_share * reasons.sliding.array());
  std::vector<char> lacking(index(mesh.points.rows()), 0);
  for (const std::int32_t i : reasons.missing) lacking[i] = 1;
  for (const std::int32_t i : reasons.missing) {
    double nearest_mm2 = std::numeric_limits<double>::infinity();
    for (Eigen::Index j = 0; j < mesh.points.rows(); ++j)
      if (lacking[j] == 0)
        nearest_mm2 = std::min(nearest_mm2, (mesh.points.row(i) - mesh.points.row(j)).squaredNorm());
    doubt_mm2[i] += std::isfinite(nearest_mm2) ? reasons.strain * std::pow(std::sqrt(nearest_mm2) + farther_mm, 2)
                                               : area_mm2;  // nothing is there, so it may be anywhere
  }
  return doubt_mm2.cwiseSqrt();
}

}  // namespace homolog
