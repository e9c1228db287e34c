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

constexpr Index moved_samples = 700, still_samples = 1200, nodes = 60;
constexpr int matching_rounds = 25, turning_rounds = 10;
constexpr double first_near = 0.06, last_near = 0.016;    ///< of the root of the surface's area
constexpr double unmatched = 0.01;                        ///< of what a full match weighs: belonging to none
constexpr double bend_length = 1, fine_length = 0.2;      ///< reach of the kernel's two scales, of the radius
constexpr double fine_share = 0.08, stretch_share = 0.1;  ///< of the radius: fine displacement; stretch or turn
constexpr float least_exponent = -25;                     ///< smaller probabilities would only cost time

/// `count` vertices spread evenly: each the farthest from those before, the first one first. Squared distances count in
/// whole steps, so that no pick hangs on the last bit of a coordinate.
std::vector<Index> spread_vertices(const Points& points, Index count) {
  constexpr double steps = 1e4;  // in the squared radius
  const double radius2 = (points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean();
  std::vector<Index> picked;
  Eigen::VectorXd away = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
  for (Index next = 0; std::ssize(picked) < std::min(count, points.rows()); away.maxCoeff(&next)) {
    picked.push_back(next);
    const VertexScalars from_next2 = (points.rowwise() - points.row(next)).rowwise().squaredNorm();
    away = away.cwiseMin((from_next2 * (steps / radius2)).array().floor().matrix());
  }
  return picked;
}

/// About `count` vertices at equal steps of the numbering.
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

CoherentMatch::Samples CoherentMatch::samples_of(const Mesh& mesh, const Points& normals,
                                                 const std::vector<Index>& at) {
  Samples samples{mesh.points(at, Eigen::all), normals(at, Eigen::all), {}};
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

CoherentMatch::Side CoherentMatch::side_of(const Mesh& mesh, const std::vector<Index>& moved) {
  const Points normals = vertex_normals(mesh);
  return {samples_of(mesh, normals, moved),
          samples_of(mesh, normals, stepped_vertices(mesh.points.rows(), still_samples))};
}

CoherentMatch::CoherentMatch(const Points& reference, const Mesh& placed, const Mesh& surface)
    : placed_(placed.points),
      nodes_(placed.points(spread_vertices(reference, nodes), Eigen::all)),
      own_(side_of(placed, spread_vertices(reference, moved_samples))),
      there_(side_of(surface, spread_vertices(surface.points, moved_samples))),
      centre_(placed.points.colwise().mean()),
      radius_mm_(std::sqrt((placed.points.rowwise() - centre_).rowwise().squaredNorm().mean())),
      size_mm_(std::sqrt(there_.still.area_mm2.cast<double>().sum())) {}

CoherentMatch::Basis CoherentMatch::basis(const Points& at, const MatchFreedom& freedom, bool with_slopes) const {
  const Points from = nodes_.rowwise() - centre_, to = at.rowwise() - centre_;
  const double bend_mm = freedom.bend_share * radius_mm_, bend_reach_mm = bend_length * radius_mm_,
               fine_mm = fine_share * radius_mm_, fine_reach_mm = fine_length * radius_mm_,
               stretch = stretch_share * stretch_share;
  const auto bumps = [](const Eigen::MatrixXd& distances_mm2, double size_mm, double reach_mm) {
    return Eigen::MatrixXd(size_mm * size_mm * (distances_mm2.array() / (-2 * reach_mm * reach_mm)).exp());
  };
  const auto kernel = [&](const Eigen::MatrixXd& bend, const Eigen::MatrixXd& fine, const Points& others) {
    return Eigen::MatrixXd((bend + fine + stretch * from * others.transpose()).array() + bend_mm * bend_mm);
  };
  const Eigen::MatrixXd among = squared_distances(from, from), apart = squared_distances(from, to);
  Eigen::MatrixXd covariance = kernel(bumps(among, bend_mm, bend_reach_mm), bumps(among, fine_mm, fine_reach_mm), from);
  covariance.diagonal().array() += 1e-6 * covariance.diagonal().maxCoeff();
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  const Eigen::MatrixXd bend = bumps(apart, bend_mm, bend_reach_mm), fine = bumps(apart, fine_mm, fine_reach_mm);
  Basis basis{root.matrixL().solve(kernel(bend, fine, to)).transpose(), {}};
  if (!with_slopes) return basis;
  const Eigen::MatrixXd steepness = bend / (bend_reach_mm * bend_reach_mm) + fine / (fine_reach_mm * fine_reach_mm);
  for (int d = 0; d < 3; ++d) {
    const Eigen::MatrixXd away = (-to.col(d).transpose()).replicate(from.rows(), 1).colwise() + from.col(d);
    const Eigen::MatrixXd slopes = steepness.cwiseProduct(away).colwise() + stretch * from.col(d);
    basis.slope[static_cast<std::size_t>(d)] = root.matrixL().solve(slopes).transpose();
  }
  return basis;
}

/// Normals turn by the inverse transpose of the displacement's derivative, which its cofactors are but for their size.
CoherentMatch::Samples CoherentMatch::displaced(const Samples& samples, const Basis& basis, const Coefficients& by) {
  Samples moved{samples.points + basis.value * by, samples.normals, samples.area_mm2};
  const std::array<Points, 3> slope{basis.slope[0] * by, basis.slope[1] * by, basis.slope[2] * by};
  for (Index i = 0; i < samples.points.rows(); ++i) {
    const Vec3 x = Vec3::UnitX() + slope[0].row(i).transpose(), y = Vec3::UnitY() + slope[1].row(i).transpose(),
               z = Vec3::UnitZ() + slope[2].row(i).transpose();
    const auto& before = samples.normals.row(i);
    const Vec3 normal = before.x() * y.cross(z) + before.y() * z.cross(x) + before.z() * x.cross(y);
    const double length = normal.norm();
    if (length > 0) moved.normals.row(i) = normal.transpose() / length;
  }
  return moved;
}

CoherentMatch::Drawn CoherentMatch::drawn(const Samples& own, const Samples& there, double near_mm,
                                          double facing) const {
  // The exponent of each pair is minus half the squared distance between rows of place and normal.
  const auto joint = [&](const Samples& samples) {
    Eigen::MatrixXf rows(samples.points.rows(), 6);
    rows.leftCols(3) = ((samples.points.rowwise() - centre_) / near_mm).cast<float>();
    rows.rightCols(3) = (facing * samples.normals).cast<float>();
    return rows;
  };
  const Eigen::MatrixXf a = joint(own), b = joint(there);
  const Eigen::VectorXf a2 = a.rowwise().squaredNorm() / 2, b2 = b.rowwise().squaredNorm() / 2;
  Eigen::MatrixXf likely = a * b.transpose();
  likely.colwise() -= a2;
  likely.rowwise() -= b2.transpose();
  likely = likely.array().max(least_exponent).min(0).exp().matrix();

  const auto none = static_cast<float>(unmatched * 2 * std::numbers::pi * near_mm * near_mm);
  const Eigen::VectorXf of_there = (likely.transpose() * own.area_mm2).array() + none,
                        of_own = (likely * there.area_mm2).array() + none;
  const Eigen::VectorXf back = there.area_mm2.cwiseQuotient(of_there), forth = own.area_mm2.cwiseQuotient(of_own);
  const Rows3f places = (there.points.rowwise() - centre_).cast<float>();
  const Eigen::VectorXf weights =
      own.area_mm2.cwiseProduct(likely * back) + forth.cwiseProduct(likely * there.area_mm2);
  const Rows3f sums = own.area_mm2.asDiagonal() * (likely * (back.asDiagonal() * places)) +
                      forth.asDiagonal() * (likely * (there.area_mm2.asDiagonal() * places));
  Drawn drawn{own.points, weights.cast<double>()};
  for (Index i = 0; i < own.points.rows(); ++i)
    if (weights[i] > 0) drawn.targets.row(i) = (sums.row(i) / weights[i]).cast<double>() + centre_;
  return drawn;
}

/// That of `own` which matches it with `there`.
CoherentMatch::Coefficients CoherentMatch::displacement(const Samples& own, const Samples& there,
                                                        const MatchFreedom& freedom, const KnownMatches& known) const {
  const Basis at_own = basis(own.points, freedom, true);
  const Eigen::MatrixXd at_known = basis(known.from, freedom, false).value;
  const double noise_mm = warp_lengths(bounds_of(placed_).diagonal().norm()).noise_mm;
  const VertexScalars sure = known.trust / (noise_mm * noise_mm);
  const Eigen::MatrixXd known_information = at_known.transpose() * sure.asDiagonal() * at_known,
                        known_pull = at_known.transpose() * (sure.asDiagonal() * (known.to - known.from));
  const double a_sample = static_cast<double>(own.points.rows()) / (2 * size_mm_ * size_mm_ * freedom.together);
  Coefficients found = Coefficients::Zero(nodes_.rows(), 3);
  for (int round = 0; round < matching_rounds; ++round) {
    const double share = static_cast<double>(round) / (matching_rounds - 1);
    const double near_mm = size_mm_ * first_near * std::pow(last_near / first_near, share);
    const auto [targets, weights] = drawn(displaced(own, at_own, found), there, near_mm, freedom.facing);
    const VertexScalars believed = a_sample / (near_mm * near_mm) * weights;
    Eigen::MatrixXd information = at_own.value.transpose() * believed.asDiagonal() * at_own.value + known_information;
    information.diagonal().array() += 1;
    const Eigen::MatrixXd pull =
        at_own.value.transpose() * (believed.asDiagonal() * (targets - own.points)) + known_pull;
    found = information.llt().solve(pull);
  }
  return found;
}

CoherentMatch::Ways CoherentMatch::match(const MatchFreedom& freedom, const KnownMatches& known) const {
  const auto displacement_at = [&](const Points& at, const Coefficients& by) {
    return Points(basis(at, freedom, false).value * by);
  };
  const Coefficients to_surface = displacement(own_.moved, there_.still, freedom, known),
                     to_shape = displacement(there_.moved, own_.still, freedom, {known.to, known.from, known.trust});
  const Points forth = placed_ + displacement_at(placed_, to_surface);
  // Each round comes nearer to what `to_shape` takes to where the shape is placed.
  Points back = forth;
  for (int round = 0; round < turning_rounds; ++round) back = placed_ - displacement_at(back, to_shape);
  return {forth, back};
}

}  // namespace homolog
