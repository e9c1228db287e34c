#include "core/groupwise/description.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

/// M×M, with 1/(M−1) and the mean over the rows. One sum after the other: the same bits whatever the number of threads.
Eigen::MatrixXd dual_covariance(const Descriptions& set) {
  const Eigen::VectorXd mean = set.rowwise().mean();
  const Descriptions centred = set.colwise() - mean;
  return centred.transpose() * centred / (static_cast<double>(set.rows()) * static_cast<double>(set.cols() - 1));
}

}  // namespace

double description_bits(const Descriptions& set, double precision) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(dual_covariance(set), Eigen::EigenvaluesOnly);
  double bits = 0;
  for (const double variance : solver.eigenvalues())
    bits += 0.5 * std::log2(1 + std::max(variance, 0.0) / (precision * precision));
  return bits;
}

Descriptions expected_from_others(const Descriptions& set, double precision) {
  const Eigen::Index shapes = set.cols();
  const double alpha = precision * precision;
  Eigen::MatrixXd regular = dual_covariance(set);
  regular.diagonal().array() += alpha;
  Eigen::MatrixXd weights = regular.llt().solve(Eigen::MatrixXd::Identity(shapes, shapes));
  // The mean is free: the constant vector, an eigenvector of eigenvalue 1/α, is taken off.
  weights.array() -= 1 / (alpha * static_cast<double>(shapes));
  Eigen::MatrixXd combination(shapes, shapes);
  for (Eigen::Index k = 0; k < shapes; ++k) {
    combination.col(k) = -weights.col(k) / weights(k, k);
    combination(k, k) = 0;
  }
  Descriptions expected(set.rows(), shapes);
  in_parallel(set.rows(), [&](Eigen::Index first, Eigen::Index last) {
    expected.middleRows(first, last - first).noalias() = set.middleRows(first, last - first) * combination;
  });
  return expected;
}

}  // namespace homolog
