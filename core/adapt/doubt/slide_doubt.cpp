#include "core/adapt/doubt/slide_doubt.h"

#include <algorithm>
#include <cmath>

#include "core/adapt/match/smooth_displacement.h"
#include "core/adapt/match/surface_samples.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

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

}  // namespace homolog
