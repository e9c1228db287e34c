#include "core/placement/known_matches.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/placement/landmark_warp.h"
#include "core/placement/likely_similarity.h"

namespace homolog {

namespace {

constexpr double least_trust = 1e-6;
constexpr double differing_reach = 0.3;  ///< share of the diagonal: how far differences between organs reach
/// Noises are compared in steps of half an octave, up to 16 times the least: what is beyond is no landmark.
constexpr int noises = 9;

/// The logarithm of how likely `offset` is under this covariance of each coordinate, but for a constant.
double log_likelihood(const Eigen::MatrixXd& covariance, const Points& offset) {
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  if (root.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  const double log_determinant = 2 * root.matrixLLT().diagonal().array().log().sum();
  return -(offset.cwiseProduct(root.solve(offset)).sum() + 3 * log_determinant) / 2;
}

}  // namespace

KnownMatches known_matches(const Points& placed, const Points& from, const Points& to, const VertexScalars& trust) {
  const double diagonal_mm = bounds_of(placed).diagonal().norm();
  WarpLengths lengths = warp_lengths(diagonal_mm);
  lengths.reach_mm = differing_reach * diagonal_mm;
  const VertexScalars clicked_mm = lengths.noise_mm * trust.cwiseMax(least_trust).cwiseSqrt().cwiseInverse();
  if (from.rows() < fewest_placing_landmarks) return {from, to, clicked_mm};
  const Eigen::MatrixXd differing = WarpKernel(placed.colwise().mean(), lengths)(from, from);
  double likeliest = -std::numeric_limits<double>::infinity(), times_likeliest = 1;
  for (int k = 0; k < noises; ++k) {
    const double times = std::exp2(0.5 * k);
    Eigen::MatrixXd covariance = differing;
    covariance.diagonal() += (times * clicked_mm).cwiseAbs2();
    const double likelihood = log_likelihood(covariance, to - from);
    if (!(likelihood > likeliest)) continue;
    likeliest = likelihood;
    times_likeliest = times;
  }
  return {from, to, times_likeliest * clicked_mm};
}

}  // namespace homolog
