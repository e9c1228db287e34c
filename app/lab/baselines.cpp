#include "app/lab/baselines.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "core/adapt/boundary/find_placement.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/geometry/surface_search.h"

namespace homolog {

namespace {

constexpr double least_part = 1e-10;  ///< of a moving point in the target, so that its system can be solved
constexpr double rests = 1e-5;        ///< change of the deviation in one round, as a share
constexpr double least_variance = 1e-8;

/// Every k-th row, so that at most `most` are left. Neighbours have near numbers, so these are spread out.
Points every_kth(const Points& points, Eigen::Index most) {
  const Eigen::Index stride = std::max<Eigen::Index>(1, (points.rows() + most - 1) / most);
  const Eigen::Index count = (points.rows() + stride - 1) / stride;
  Points some(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) some.row(k) = points.row(k * stride);
  return some;
}

/// exp(−‖a − b‖²/2β²), a row for each of `a`.
Eigen::MatrixXd smoothing(const Points& a, const Points& b, double beta) {
  Eigen::MatrixXd kernel(a.rows(), b.rows());
  in_parallel(b.rows(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index j = first; j < last; ++j)
      kernel.col(j) = ((a.rowwise() - b.row(j)).rowwise().squaredNorm() / (-2 * beta * beta)).array().exp();
  });
  return kernel;
}

/// How much each pair belongs together [Myronenko and Song 2010, Eq. 6]: a column for each fixed point.
Eigen::MatrixXd matches(const Points& moved, const Points& fixed, double variance, double outliers) {
  const double of_none = std::pow(2 * std::numbers::pi * variance, 1.5) * outliers / (1 - outliers) *
                         static_cast<double>(moved.rows()) / static_cast<double>(fixed.rows());
  Eigen::MatrixXd match(moved.rows(), fixed.rows());
  in_parallel(fixed.rows(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index n = first; n < last; ++n) {
      match.col(n) = ((moved.rowwise() - fixed.row(n)).rowwise().squaredNorm() / (-2 * variance)).array().exp();
      match.col(n) /= match.col(n).sum() + of_none;
    }
  });
  return match;
}

Points placed(const Template& the_template, const Boundary& boundary) {
  return find_placement(the_template, boundary).placement.apply(the_template.points);
}

}  // namespace

Result<Points> point_drift(const Points& moving, const Points& fixed, const PointDriftOptions& options) {
  if (moving.rows() < 4 || fixed.rows() < 4) return fail("", "point drift needs at least four points on each side");
  const Eigen::RowVector3d centre = fixed.colwise().mean();
  const double unit_mm = std::sqrt((fixed.rowwise() - centre).squaredNorm() / static_cast<double>(fixed.size()));
  if (!(unit_mm > 0)) return fail("", "point drift needs points that have an extent");
  // Both in one unit around the target's centre: the placement stays.
  const Points all = (moving.rowwise() - centre) / unit_mm;
  const Points y = every_kth(all, options.points),
               x = every_kth((fixed.rowwise() - centre) / unit_mm, options.points * 3 / 2);
  const Eigen::MatrixXd kernel = smoothing(y, y, options.beta);
  Eigen::MatrixX3d weights = Eigen::MatrixX3d::Zero(y.rows(), 3);
  Points moved = y;
  double variance = 0;
  for (Eigen::Index n = 0; n < x.rows(); ++n) variance += (y.rowwise() - x.row(n)).squaredNorm();
  variance /= 3 * static_cast<double>(x.rows() * y.rows());
  for (int round = 0; round < options.most_rounds && variance > least_variance; ++round) {
    const Eigen::MatrixXd match = matches(moved, x, variance, options.outliers);
    const Eigen::VectorXd of_moving = match.rowwise().sum().cwiseMax(least_part), of_fixed = match.colwise().sum();
    const Eigen::MatrixX3d targets = match * x;
    // The M step, divided by the diagonal of `of_moving`, so that the matrix is symmetric and positive definite.
    Eigen::MatrixXd system = kernel;
    system.diagonal() += options.lambda * variance * of_moving.cwiseInverse();
    weights = system.llt().solve(of_moving.cwiseInverse().asDiagonal() * targets - Eigen::MatrixX3d(y));
    moved = y + kernel * weights;
    const double before = variance;
    variance = (of_fixed.dot(x.rowwise().squaredNorm()) - 2 * targets.cwiseProduct(moved).sum() +
                of_moving.dot(moved.rowwise().squaredNorm())) /
               (3 * of_fixed.sum());
    if (options.progress != nullptr) {
      options.progress->report(static_cast<double>(round + 1) / options.most_rounds);
      if (options.progress->cancelled()) return fail("", "the point drift was cancelled");
    }
    if (std::abs(before - variance) < rests * before) break;
  }
  const Points carried = all + smoothing(all, y, options.beta) * weights;
  return Points((unit_mm * carried).rowwise() + centre);
}

Points closest_points_fit(const Template& the_template, const Boundary& boundary) {
  return closest_places(boundary.surface, placed(the_template, boundary));
}

Result<Points> point_drift_fit(const Template& the_template, const Boundary& boundary,
                               const PointDriftOptions& options) {
  const auto drifted = point_drift(placed(the_template, boundary), boundary.surface.points, options);
  if (!drifted) return drifted;
  return closest_places(boundary.surface, *drifted);
}

}  // namespace homolog
