#include "core/statistics/parallel_analysis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "core/base/numbers/random.h"
#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

constexpr std::size_t shuffles = 99;
constexpr std::size_t percentile_place = 94;  ///< from 0: the 95th of 99

/// Descending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& centred) {
  const Eigen::MatrixXd products = centred.transpose() * centred;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(products, Eigen::EigenvaluesOnly).eigenvalues().reverse();
}

Eigen::MatrixXd shuffled(Eigen::MatrixXd rows, std::uint64_t seed) {
  Random random(seed);
  for (Eigen::Index j = rows.cols() - 1; j > 0; --j)
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const auto other = static_cast<Eigen::Index>(random.uniform() * static_cast<double>(j + 1));
      std::swap(rows(i, j), rows(i, std::min(j, other)));
    }
  return rows;
}

}  // namespace

Eigen::Index modes_above_chance(const Eigen::MatrixXd& responses, std::uint64_t seed, Progress* progress) {
  const Eigen::VectorXd mean = responses.rowwise().mean();
  const Eigen::MatrixXd centred = responses.colwise() - mean;
  const Eigen::VectorXd own = eigenvalues(centred);
  std::vector<Eigen::VectorXd> chance(shuffles, Eigen::VectorXd::Zero(own.size()));
  for_each_in_parallel(shuffles, [&](std::size_t k) {
    if (progress != nullptr && progress->cancelled()) return;
    chance[k] = eigenvalues(shuffled(centred, mix_bits(seed) + k));
  });
  for (Eigen::Index mode = 0; mode < own.size(); ++mode) {
    std::vector<double> values;
    for (const Eigen::VectorXd& one : chance) values.push_back(one[mode]);
    std::nth_element(values.begin(), values.begin() + percentile_place, values.end());
    if (!(own[mode] > values[percentile_place])) return mode;
  }
  return own.size();
}

}  // namespace homolog
