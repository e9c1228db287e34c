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
  const Points from = a.rowwise() - centre_, to = b.rowwise() - centre_;
  const Eigen::MatrixXd products = from * to.transpose();
  const Eigen::VectorXd a2 = from.rowwise().squaredNorm(), b2 = to.rowwise().squaredNorm();
  const Eigen::MatrixXd distance2 = (-2 * products).colwise() + a2;
  return lengths_.bump_mm * lengths_.bump_mm *
             (-(distance2.rowwise() + b2.transpose()).array() / (2 * lengths_.reach_mm * lengths_.reach_mm))
                 .exp()
                 .matrix() +
         stretch_share * stretch_share * products;
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
