#include "core/adapt/match/coherent_match.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/mesh/mesh_quality.h"
#include "core/placement/landmark_warp.h"

namespace homolog {

namespace {

using Eigen::Index;
using Rows3f = Eigen::Matrix<float, Eigen::Dynamic, 3>;

constexpr Index own_samples = 700, there_samples = 1200, nodes = 60;
constexpr int matching_rounds = 25;
constexpr double first_near = 0.06, last_near = 0.012;    ///< of the root of the surface's area
constexpr double unmatched = 0.01;                        ///< of what a full match weighs: belonging to none
constexpr double bend_length = 1, fine_length = 0.3;      ///< reach of the kernel's two scales, of the radius
constexpr double fine_share = 0.05, stretch_share = 0.1;  ///< of the radius: fine displacement; stretch or turn
constexpr float least_exponent = -25;                     ///< smaller probabilities would only cost time

/// `count` vertices spread evenly: each the farthest from those before, the first one first.
std::vector<Index> spread_vertices(const Points& points, Index count) {
  std::vector<Index> picked;
  Eigen::VectorXd away = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
  for (Index next = 0; std::ssize(picked) < std::min(count, points.rows()); away.maxCoeff(&next)) {
    picked.push_back(next);
    away = away.cwiseMin((points.rowwise() - points.row(next)).rowwise().squaredNorm());
  }
  return picked;
}

/// About `count` vertices at equal steps of the numbering. They do not hang on the last bit of a coordinate.
std::vector<Index> stepped_vertices(Index vertices, Index count) {
  std::vector<Index> picked;
  for (Index v = 0; v < vertices; v += 1 + vertices / count) picked.push_back(v);
  return picked;
}

Eigen::MatrixXd squared_distances(const Points& a, const Points& b) {
  const Eigen::VectorXd a2 = a.rowwise().squaredNorm(), b2 = b.rowwise().squaredNorm();
  Eigen::MatrixXd distances = -2 * a * b.transpose();
  distances.colwise() += a2;
  distances.rowwise() += b2.transpose();
  return distances;
}

}  // namespace

CoherentMatch::Samples CoherentMatch::samples_of(const Mesh& mesh, const std::vector<Index>& at) {
  Samples samples{mesh.points(at, Eigen::all), vertex_normals(mesh)(at, Eigen::all), {}};
  const double area_mm2 = surface_area_mm2(mesh);
  // The denser the samples, the less each stands for. A count of what lies nearest to each would hang on ties.
  const double spacing_mm2 = area_mm2 / static_cast<double>(at.size());
  const Eigen::VectorXd share = (squared_distances(samples.points, samples.points).array() / (-2 * spacing_mm2))
                                    .exp()
                                    .matrix()
                                    .rowwise()
                                    .sum()
                                    .cwiseInverse();
  samples.area_mm2 = (area_mm2 / share.sum() * share).cast<float>();
  return samples;
}

CoherentMatch::CoherentMatch(const Points& reference, const Mesh& placed, const Mesh& surface)
    : placed_(placed),
      own_at_(spread_vertices(reference, own_samples)),
      nodes_(placed.points(spread_vertices(reference, nodes), Eigen::all)),
      own_(samples_of(placed, own_at_)),
      there_(samples_of(surface, stepped_vertices(surface.points.rows(), there_samples))),
      centre_(placed.points.colwise().mean()),
      radius_mm_(std::sqrt((placed.points.rowwise() - centre_).rowwise().squaredNorm().mean())),
      size_mm_(std::sqrt(there_.area_mm2.cast<double>().sum())) {}

Eigen::MatrixXd CoherentMatch::kernel(const Points& a, const Points& b, const MatchFreedom& freedom) const {
  const Points from = a.rowwise() - centre_, to = b.rowwise() - centre_;
  const Eigen::MatrixXd distances = squared_distances(from, to);
  const auto bumps = [&](double reach_share) {
    const double reach_mm = reach_share * radius_mm_;
    return (distances.array() / (-2 * reach_mm * reach_mm)).exp();
  };
  const double bend_mm = freedom.bend_share * radius_mm_, fine_mm = fine_share * radius_mm_;
  return (bend_mm * bend_mm * (1 + bumps(bend_length)) + fine_mm * fine_mm * bumps(fine_length)).matrix() +
         stretch_share * stretch_share * from * to.transpose();
}

/// Functions of place whose sum with independent standard normal coefficients is the process, as the nodes see it.
Eigen::MatrixXd CoherentMatch::basis(const Points& at, const MatchFreedom& freedom) const {
  Eigen::MatrixXd covariance = kernel(nodes_, nodes_, freedom);
  covariance.diagonal().array() += 1e-6 * covariance.diagonal().maxCoeff();
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  return root.matrixL().solve(kernel(nodes_, at, freedom)).transpose();
}

CoherentMatch::Drawn CoherentMatch::drawn(const Points& own, const Points& normals, double near_mm,
                                          double facing) const {
  // The exponent of each pair is minus half the squared distance between rows of place and normal.
  const auto joint = [&](const Points& points, const Points& facing_to) {
    Eigen::MatrixXf rows(points.rows(), 6);
    rows.leftCols(3) = ((points.rowwise() - centre_) / near_mm).cast<float>();
    rows.rightCols(3) = (facing * facing_to).cast<float>();
    return rows;
  };
  const Eigen::MatrixXf a = joint(own, normals), b = joint(there_.points, there_.normals);
  const Eigen::VectorXf a2 = a.rowwise().squaredNorm() / 2, b2 = b.rowwise().squaredNorm() / 2;
  Eigen::MatrixXf likely = a * b.transpose();
  likely.colwise() -= a2;
  likely.rowwise() -= b2.transpose();
  likely = likely.array().max(least_exponent).min(0).exp().matrix();

  const auto none = static_cast<float>(unmatched * 2 * std::numbers::pi * near_mm * near_mm);
  const Eigen::VectorXf of_there = (likely.transpose() * own_.area_mm2).array() + none,
                        of_own = (likely * there_.area_mm2).array() + none;
  const Eigen::VectorXf back = there_.area_mm2.cwiseQuotient(of_there), forth = own_.area_mm2.cwiseQuotient(of_own);
  const Rows3f places = (there_.points.rowwise() - centre_).cast<float>();
  const Eigen::VectorXf weights =
      own_.area_mm2.cwiseProduct(likely * back) + forth.cwiseProduct(likely * there_.area_mm2);
  const Rows3f sums = own_.area_mm2.asDiagonal() * (likely * (back.asDiagonal() * places)) +
                      forth.asDiagonal() * (likely * (there_.area_mm2.asDiagonal() * places));
  Drawn drawn{own, weights.cast<double>()};
  for (Index i = 0; i < own.rows(); ++i)
    if (weights[i] > 0) drawn.targets.row(i) = (sums.row(i) / weights[i]).cast<double>() + centre_;
  return drawn;
}

Points CoherentMatch::match(const MatchFreedom& freedom, const KnownMatches& known) const {
  const Eigen::MatrixXd own_basis = basis(own_.points, freedom), basis_of_all = basis(placed_.points, freedom),
                        known_basis = basis(known.from, freedom);
  const double noise_mm = warp_lengths(bounds_of(placed_.points).diagonal().norm()).noise_mm;
  const VertexScalars sure = known.trust / (noise_mm * noise_mm);
  const Eigen::MatrixXd known_information = known_basis.transpose() * sure.asDiagonal() * known_basis,
                        known_pull = known_basis.transpose() * (sure.asDiagonal() * (known.to - known.from));
  const double a_sample = static_cast<double>(own_.points.rows()) / (2 * size_mm_ * size_mm_ * freedom.together);
  Mesh mesh = placed_;
  for (int round = 0; round < matching_rounds; ++round) {
    const double share = static_cast<double>(round) / (matching_rounds - 1);
    const double near_mm = size_mm_ * first_near * std::pow(last_near / first_near, share);
    const auto [targets, weights] =
        drawn(mesh.points(own_at_, Eigen::all), vertex_normals(mesh)(own_at_, Eigen::all), near_mm, freedom.facing);
    const VertexScalars believed = a_sample / (near_mm * near_mm) * weights;
    Eigen::MatrixXd information = own_basis.transpose() * believed.asDiagonal() * own_basis + known_information;
    information.diagonal().array() += 1;
    const Eigen::MatrixXd pull = own_basis.transpose() * (believed.asDiagonal() * (targets - own_.points)) + known_pull;
    mesh.points = placed_.points + basis_of_all * information.llt().solve(pull);
  }
  return mesh.points;
}

}  // namespace homolog
