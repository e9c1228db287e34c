#include "app/editor/state/figures/quality.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/adapt/judge_fit.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// Whether a triangle is thin, and not so by the template's design, as the fan at a tube's apex is.
bool became_thin(const Mesh& mesh, const Mesh& placed, std::int32_t face) {
  const double angle_deg = smallest_angle_deg(mesh, face);
  if (angle_deg >= thin_below_deg) return false;
  const double before_deg = smallest_angle_deg(placed, face);
  return before_deg >= thin_below_deg || angle_deg < before_deg / 2;
}

std::vector<Finding> findings(const Mesh& mesh, const Mesh& placed, const QualityFigures& figures,
                              const std::vector<std::int32_t>& turned) {
  std::vector<Finding> all;
  const auto add = [&](FindingKind kind, const std::vector<FacePair>& pairs) {
    const auto found = findings_of(kind, mesh, pairs);
    all.insert(all.end(), found.begin(), found.end());
  };
  if (figures.intersecting > 0) add(FindingKind::intersecting, self_intersections(mesh));
  std::vector<FacePair> faces;
  for (const std::int32_t face : turned) faces.push_back({face, face});
  add(FindingKind::turned, faces);
  faces.clear();
  for (std::int32_t face = 0; face < mesh.topology->triangles().rows(); ++face)
    if (became_thin(mesh, placed, face)) faces.push_back({face, face});
  add(FindingKind::thin, faces);
  return all;
}

}  // namespace

QualityFigures quality_figures(const ShapeView& shown) {
  const Topology& topology = *shown.the_template().topology;
  const Shape& shape = shown.shape;
  const Points& p = *shape.points;
  const Points& placed = *shape.placed;

  QualityFigures figures;
  std::vector<double> stretch;
  stretch.reserve(topology.edges().size());
  for (const auto& [i, j] : topology.edges()) {
    const double before = (placed.row(i) - placed.row(j)).norm();
    if (before > 0) stretch.push_back((p.row(i) - p.row(j)).norm() / before);
  }
  if (!stretch.empty()) {
    std::sort(stretch.begin(), stretch.end());
    const auto quantile = [&](double share) {
      return stretch[static_cast<std::size_t>(share * static_cast<double>(stretch.size() - 1) + 0.5)];
    };
    figures.stretch_low = quantile(0.05);
    figures.stretch_median = quantile(0.5);
    figures.stretch_high = quantile(0.95);
  }
  const Eigen::VectorXd moved = (p - *shape.reference).rowwise().norm();
  figures.moved_mean_mm = moved.mean();
  figures.moved_max_mm = moved.maxCoeff();
  const Mesh mesh = shown.mesh();
  const MeshQuality quality = mesh_quality(mesh);
  figures.edge_mean_mm = quality.edge_mean;
  figures.edge_cv = quality.edge_cv;
  figures.regular_share = quality.regular_share;
  figures.min_angle_deg = quality.min_angle_deg;
  figures.intersecting = quality.self_intersections;
  figures.all_intersecting = quality.all_intersections;
  figures.volume_ml = quality.volume_ml;
  const auto turned = turned_triangles(topology, placed, p);
  figures.turned = turned.size();
  figures.findings = findings(mesh, {mesh.topology, placed}, figures, turned);
  const VertexScalars doubt_mm = doubt_left_mm(shape);
  if (doubt_mm.size() == 0) return figures;
  figures.doubt_mean_mm = doubt_mm.mean();
  figures.doubt_max_mm = doubt_mm.maxCoeff();
  for (Finding& place : doubtful_places(mesh, doubt_mm, much_doubt_mm(quality.area_mm2)))
    figures.findings.push_back(std::move(place));
  return figures;
}

}  // namespace homolog
