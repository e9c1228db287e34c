#include "core/adapt/cut_template.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/mesh_quality.h"

namespace homolog {

std::vector<ScanBorder> cut_borders(const Template& the_template, const Points& points) {
  constexpr double tolerance_edges = 0.75;  ///< the rim of a flat face is round by about this
  constexpr double least_share = 0.01;      ///< of the area: a smaller face hardly draws a fit aside
  std::vector<ScanBorder> borders;
  std::vector<char> left(static_cast<std::size_t>(points.rows()), 0);
  for (const std::int32_t i : vertices_in(the_template.regions, cut_region)) left[static_cast<std::size_t>(i)] = 1;
  const Topology& topology = *the_template.topology;
  const Points normals = vertex_normals({the_template.topology, points});
  const double least = least_share * static_cast<double>(points.rows());  // vertices are spread evenly
  for (std::size_t seed = 0; seed < left.size(); ++seed) {
    if (left[seed] == 0) continue;
    std::vector<std::int32_t> patch{static_cast<std::int32_t>(seed)};
    left[seed] = 0;
    for (std::size_t k = 0; k < patch.size(); ++k)
      for (const std::int32_t j : topology.one_ring(patch[k]))
        if (left[static_cast<std::size_t>(j)] != 0) {
          left[static_cast<std::size_t>(j)] = 0;
          patch.push_back(j);
        }
    if (static_cast<double>(patch.size()) < least) continue;
    const Eigen::RowVector3d outward = normals(patch, Eigen::all).colwise().mean();
    if (!(outward.norm() > 0)) continue;
    ScanBorder border;
    border.outward = outward.normalized().transpose();
    border.offset_mm = border.outward.dot(Vec3(points(patch, Eigen::all).colwise().mean()));
    const double edge_mm = mean_edge_mm(topology, points);
    double deepest_mm = 0;
    for (const std::int32_t i : patch)
      deepest_mm = std::max(deepest_mm, border.offset_mm - border.outward.dot(Vec3(points.row(i))));
    border.tolerance_mm = std::max(tolerance_edges * edge_mm, std::min(deepest_mm, edge_mm) * 1.01);
    borders.push_back(border);
  }
  return borders;
}

Boundary cut_as_template(const Boundary& boundary, const std::vector<ScanBorder>& template_cuts) {
  Boundary cut = boundary;
  cut.scan_borders.insert(cut.scan_borders.end(), template_cuts.begin(), template_cuts.end());
  return cut;
}

}  // namespace homolog
