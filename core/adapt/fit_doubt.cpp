#include "core/adapt/fit_doubt.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/adapt/match/smooth_displacement.h"
#include "core/adapt/match/surface_samples.h"
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
      if (lacking[j] == 0) nearest_mm2 = std::min(nearest_mm2, (mesh.points.row(i) - mesh.points.row(j)).squaredNorm());
    doubt_mm2[i] += std::isfinite(nearest_mm2) ? reasons.strain * std::pow(std::sqrt(nearest_mm2) + farther_mm, 2)
                                               : area_mm2;  // nothing is there, so it may be anywhere
  }
  return doubt_mm2.cwiseSqrt();
}

namespace {

using Eigen::Index;

constexpr Index sliding_nodes = 200, sliding_samples = 600;
/// Shares of the root of the surface's area: how far places may go astray, over which distance they go together, how
/// well a sample sees its distance from the surface.
constexpr double astray_share = 0.04, together_share = 0.08, seen_share = 0.01;

/// The mean at each vertex of what samples near it have, n. `near_mm`: about.
VertexScalars spread_to_vertices(const Points& points, const Points& samples, const VertexScalars& of_samples,
                                 double near_mm) {
  VertexScalars all(points.rows());
  for (Index i = 0; i < points.rows(); ++i) {
    const Eigen::ArrayXd apart_mm2 = (samples.rowwise() - points.row(i)).rowwise().squaredNorm();
    const Eigen::ArrayXd counts = ((apart_mm2.minCoeff() - apart_mm2) / (2 * near_mm * near_mm)).exp();
    all[i] = (counts * of_samples.array()).sum() / counts.sum();
  }
  return all;
}

}  // namespace

VertexScalars shares_of_sliding(const Mesh& mesh) {
  const VertexScalars alike = VertexScalars::Ones(mesh.points.rows());
  const double size_mm = std::sqrt(surface_area_mm2(mesh));
  if (!(size_mm > 0) || !mesh.points.allFinite()) return alike;
  const std::vector<Index> spread = spread_vertices(mesh.points, sliding_samples);
  const auto nodes = std::min<Index>(sliding_nodes, std::ssize(spread));
  const Points at_nodes = mesh.points(std::vector<Index>(spread.begin(), spread.begin() + nodes), Eigen::all),
               at_samples = mesh.points(spread, Eigen::all), normals = vertex_normals(mesh)(spread, Eigen::all);
  const SmoothDisplacement displacement(at_nodes, mesh.points.colwise().mean(),
                                        {astray_share * size_mm, together_share * size_mm, 0, size_mm, 0});
  const Eigen::MatrixXd at_each = displacement.basis(at_samples).value;
  const Eigen::MatrixXf seen = (at_each / (seen_share * size_mm)).cast<float>();
  Eigen::MatrixXf along_normals(seen.rows(), 3 * nodes);
  for (int d = 0; d < 3; ++d)
    along_normals.middleCols(d * nodes, nodes) = normals.col(d).cast<float>().asDiagonal() * seen;
  Eigen::MatrixXf information = Eigen::MatrixXf::Identity(3 * nodes, 3 * nodes);
  information.selfadjointView<Eigen::Lower>().rankUpdate(along_normals.transpose());
  const Eigen::LLT<Eigen::MatrixXf> root(information.selfadjointView<Eigen::Lower>());
  if (root.info() != Eigen::Success) return alike;

  // A place's doubt: what the nodes leave open whatever is seen, and what seeing leaves of the rest.
  const double before_mm2 = 2 * std::pow(astray_share * size_mm, 2);  // a bump's and a whole shift's
  VertexScalars left_mm2 = 3 * (before_mm2 - at_each.rowwise().squaredNorm().array()).cwiseMax(0);
  for (int d = 0; d < 3; ++d) {  // all before a coordinate's own coefficients stays 0
    const Index size = (3 - d) * nodes;
    Eigen::MatrixXf whitened = Eigen::MatrixXf::Zero(size, at_each.rows());
    whitened.topRows(nodes) = at_each.transpose().cast<float>();
    const Eigen::MatrixXf corner = root.matrixLLT().bottomRightCorner(size, size);
    corner.triangularView<Eigen::Lower>().solveInPlace(whitened);
    left_mm2 += whitened.colwise().squaredNorm().transpose().cast<double>();
  }
  const double near_mm = size_mm / std::sqrt(static_cast<double>(at_each.rows())) / 2;
  const VertexScalars left = spread_to_vertices(mesh.points, at_samples, left_mm2, near_mm);
  const double mean_mm2 = left.mean();
  return mean_mm2 > 0 && std::isfinite(mean_mm2) ? VertexScalars(left / mean_mm2) : alike;
}

namespace {

/// Sphericities, 1 of a ball. The femora, hips and vertebrae that were measured lie at 0.3 to 0.6, kidneys at 0.69 to
/// 0.87.
constexpr double has_features = 0.6, is_round = 0.68;

}  // namespace

double roundness(const Mesh& mesh) {
  const double volume_mm3 = 1000 * std::abs(enclosed_volume_ml(mesh)),
               of_ball_mm2 = std::cbrt(36 * std::numbers::pi * volume_mm3 * volume_mm3),
               sphericity = of_ball_mm2 / surface_area_mm2(mesh);
  return std::clamp((sphericity - has_features) / (is_round - has_features), 0.0, 1.0);
}

}  // namespace homolog
