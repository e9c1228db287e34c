#include "core/placement/landmark_warp.h"

#include <Eigen/Cholesky>

#include "core/deform/fold_guard.h"

namespace homolog {

namespace {

constexpr double reach_share = 0.25, bump_share = 0.045, noise_share = 0.005;
constexpr double stretch_share = 0.03;  // typical stretch or shear of an organ against its template's similarity

}  // namespace

WarpLengths warp_lengths(double diagonal_mm) {
  return {reach_share * diagonal_mm, bump_share * diagonal_mm, noise_share * diagonal_mm};
}

WarpLengths older_warp_lengths(double diagonal_mm) {
  return {reach_share * diagonal_mm, 6, 0.7};
}

Eigen::MatrixXd WarpKernel::operator()(const Points& a, const Points& b) const {
  // Column by column, so that no matrix of intermediate values goes through memory.
  const Eigen::ArrayX3d from = (a.rowwise() - centre_).array();
  const double per_mm2 = -0.5 / (lengths_.reach_mm * lengths_.reach_mm), bump_mm2 = lengths_.bump_mm * lengths_.bump_mm,
               linear = stretch_share * stretch_share;
  Eigen::MatrixXd covariance(a.rows(), b.rows());
  for (Eigen::Index j = 0; j < b.rows(); ++j) {
    const Eigen::RowVector3d to = b.row(j) - centre_;
    const auto apart_mm2 =
        (from.col(0) - to[0]).square() + (from.col(1) - to[1]).square() + (from.col(2) - to[2]).square();
    covariance.col(j).array() = bump_mm2 * (per_mm2 * apart_mm2).exp() +
                                linear * (from.col(0) * to[0] + from.col(1) * to[1] + from.col(2) * to[2]);
  }
  return covariance;
}

LandmarkWarp::LandmarkWarp(const Points& from, const Points& to, const WarpLengths& lengths)
    : from_(from), kernel_(from.colwise().mean(), lengths) {
  Eigen::MatrixXd k = kernel_(from_, from_);
  k.diagonal().array() += lengths.noise_mm * lengths.noise_mm;
  weights_ = k.llt().solve(Eigen::MatrixX3d(to - from));
}

Points LandmarkWarp::apply(const Points& points) const {
  return points + kernel_(points, from_) * weights_;
}

WarpedReference without_folds(const Topology& topology, const Points& placed, const Points& offset) {
  const FoldGuard guard(topology, placed, placed);
  const auto at = [&](double share) { return Points(placed + share * offset); };
  const double share = guard.accepted_step(1, at);
  return {at(share), share, share < 1};
}

WarpedReference warp_to_landmarks(const Topology& topology, const Points& placed, const Points& from, const Points& to,
                                  const WarpLengths& lengths) {
  if (from.rows() < fewest_warp_landmarks) return {placed};
  const LandmarkWarp warp(from, to, lengths);
  return without_folds(topology, placed, warp.apply(placed) - placed);
}

}  // namespace homolog
