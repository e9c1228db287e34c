#include "core/placement/landmark_warp.h"

#include <Eigen/Cholesky>

namespace homolog {

namespace {

constexpr double bump_mm = 6;           // what a landmark typically is off by after the similarity
constexpr double stretch_share = 0.03;  // typical stretch or shear of an organ against its template's similarity
constexpr double noise_mm = 0.7;        // how well a person clicks a landmark

}  // namespace

LandmarkWarp::LandmarkWarp(const Points& from, const Points& to, double length_mm)
    : from_(from), centre_(from.colwise().mean()), length_mm_(length_mm) {
  Eigen::MatrixXd k = kernel(from_);
  k.diagonal().array() += noise_mm * noise_mm;
  weights_ = k.llt().solve(Eigen::MatrixX3d(to - from));
}

Eigen::MatrixXd LandmarkWarp::kernel(const Points& points) const {
  const Points a = points.rowwise() - centre_, b = from_.rowwise() - centre_;
  const Eigen::MatrixXd products = a * b.transpose();
  const Eigen::VectorXd a2 = a.rowwise().squaredNorm(), b2 = b.rowwise().squaredNorm();
  const Eigen::MatrixXd distance2 = (-2 * products).colwise() + a2;
  return bump_mm * bump_mm *
             (-(distance2.rowwise() + b2.transpose()).array() / (2 * length_mm_ * length_mm_)).exp().matrix() +
         stretch_share * stretch_share * products;
}

Points LandmarkWarp::apply(const Points& points) const {
  return points + kernel(points) * weights_;
}

}  // namespace homolog
