#include "core/adapt/boundary/cut_template.h"

#include <algorithm>
#include <utility>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/patches.h"

namespace homolog {

std::vector<ScanBorder> cut_borders(const Template& the_template, const Points& points) {
  constexpr double tolerance_edges = 0.75;  ///< the rim of a flat face is round by about this
  constexpr double least_share = 0.01;      ///< share of the vertices: a smaller face hardly draws a fit aside
  std::vector<ScanBorder> borders;
  std::vector<char> marked(static_cast<std::size_t>(points.rows()), 0);
  for (const std::int32_t i : vertices_in(the_template.regions, cut_region)) marked[i] = 1;
  const Topology& topology = *the_template.topology;
  const Points normals = vertex_normals({the_template.topology, points});
  const double edge_mm = mean_edge_mm(topology, points);
  for (const auto& patch : patches_of(topology, std::move(marked))) {
    if (static_cast<double>(patch.size()) < least_share * static_cast<double>(points.rows())) continue;
    const Eigen::RowVector3d outward = normals(patch, Eigen::all).colwise().mean();
    if (!(outward.norm() > 0)) continue;
    ScanBorder border;
    border.outward = outward.normalized().transpose();
    border.offset_mm = border.outward.dot(Vec3(points(patch, Eigen::all).colwise().mean()));
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
