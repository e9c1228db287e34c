#include "core/deform/falloff.h"

#include <algorithm>

namespace homolog {

VertexScalars gaussian_falloff(const Topology& topology, const Points& points, const SurfacePoint& q, double sigma_mm,
                               double edge_mm, bool through_space) {
  const double sigma = std::max(sigma_mm, edge_mm / 2);
  const Eigen::RowVector3d centre = q.interpolate(topology, points);
  VertexScalars g = (points.rowwise() - centre).rowwise().squaredNorm();
  const std::int32_t sheet = topology.component()[topology.triangles()(q.face, 0)];
  const bool other_sheets = topology.components() > 1 && !through_space;
  double nearest = g.maxCoeff();
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    if (!other_sheets || topology.component()[i] == sheet) nearest = std::min(nearest, g[i]);
  }
  g = (-(g.array() - nearest) / (2 * sigma * sigma)).exp();
  if (other_sheets) {
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      if (topology.component()[i] != sheet) g[i] = 0;
    }
  }
  return g;
}

}  // namespace homolog
