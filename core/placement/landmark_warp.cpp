#include "core/placement/landmark_warp.h"

#include <Eigen/Cholesky>

#include "core/deform/fold_guard.h"

namespace homolog {

namespace {

constexpr double reach_share = 0.25;    // of the template's bounding-box diagonal
constexpr double bump_mm = 6;           // what a landmark typically is off by after the similarity
constexpr double stretch_share = 0.03;  // typical stretch or shear of an organ against its template's similarity

}  // namespace

Eigen::MatrixXd WarpKernel::operator()(const Points& a, const Points& b) const {
  const Points from = a.rowwise() - centre_, to = b.rowwise() - centre_;
  const Eigen::MatrixXd products = from * to.transpose();
  const Eigen::VectorXd a2 = from.rowwise().squaredNorm(), b2 = to.rowwise().squaredNorm();
  const Eigen::MatrixXd distance2 = (-2 * products).colwise() + a2;
  return bump_mm * bump_mm *
             (-(distance2.rowwise() + b2.transpose()).array() / (2 * length_mm_ * length_mm_)).exp().matrix() +
         stretch_share * stretch_share * products;
}

LandmarkWarp::LandmarkWarp(const Points& from, const Points& to, double length_mm)
    : from_(from), kernel_(from.colwise().mean(), length_mm) {
  Eigen::MatrixXd k = kernel_(from_, from_);
  k.diagonal().array() += landmark_noise_mm * landmark_noise_mm;
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

WarpedReference warp_to_landmarks(const Topology& topology, const Points& placed, const Points& from,
                                  const Points& to) {
  if (from.rows() < fewest_warp_landmarks) return {placed};
  const LandmarkWarp warp(from, to, reach_share * bounds_of(placed).diagonal().norm());
  return without_folds(topology, placed, warp.apply(placed) - placed);
}

}  // namespace homolog
