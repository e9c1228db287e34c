#include "core/measure/primitive_fits.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>
#include <string>

namespace homolog {

namespace {

/// Shares of the size below which points count as being in one place, on a line or in a plane.
constexpr double nothing = 1e-10;

/// The points' mean and how they spread.
struct PointSpread {
  Vec3 mean = Vec3::Zero();
  double weight = 0;
  Eigen::SelfAdjointEigenSolver<Mat3> axes;  ///< axes of the covariance: variances in mm², rising
  double size_mm() const { return std::sqrt(std::max(axes.eigenvalues()[2], 0.0)); }
  /// Whether the spread along the axes from the smallest to `axis` is nothing.
  bool flat(int axis) const { return axes.eigenvalues()[axis] <= nothing * axes.eigenvalues()[2]; }
};

Result<PointSpread> spread_of_points(const Points& points, const VertexScalars& weights, Eigen::Index least) {
  if (points.rows() < least)
    return fail("", "needs at least " + std::to_string(least) + " points and has " + std::to_string(points.rows()));
  PointSpread spread;
  spread.weight = weights.sum();
  if (!(spread.weight > 0)) return fail("", "lies on faces without area");
  spread.mean = (points.transpose() * weights) / spread.weight;
  const Points off = points.rowwise() - spread.mean.transpose();
  const Mat3 covariance = off.transpose() * weights.asDiagonal() * off / spread.weight;
  spread.axes.compute(covariance);
  if (!(spread.axes.eigenvalues()[2] > 0)) return fail("", "has all its points in one place");
  return spread;
}

/// The points about their mean, in units of their size, so that all numbers are near 1.
Points in_own_size(const Points& points, const PointSpread& spread) {
  return (points.rowwise() - spread.mean.transpose()) / spread.size_mm();
}

double weighed_rms(const Eigen::VectorXd& residuals, const VertexScalars& weights) {
  return std::sqrt(residuals.cwiseAbs2().dot(weights) / weights.sum());
}

/// A cylinder of points in their own size, while it is fitted.
struct CylinderGuess {
  Vec3 at = Vec3::Zero(), direction;
  double radius = 1;

  Vec3 from_axis(const Vec3& p) const { return (p - at) - (p - at).dot(direction) * direction; }
  Eigen::VectorXd residuals(const Points& points) const {
    Eigen::VectorXd off(points.rows());
    for (Eigen::Index i = 0; i < off.size(); ++i) off[i] = from_axis(points.row(i).transpose()).norm() - radius;
    return off;
  }
  CylinderGuess moved(const Eigen::Matrix<double, 5, 1>& step, const Vec3& u, const Vec3& v) const {
    CylinderGuess next = *this;
    next.direction = (direction + step[0] * u + step[1] * v).normalized();
    next.at += step[2] * u + step[3] * v;
    next.radius += step[4];
    return next;
  }
};

/// Two unit directions across a third.
void across(const Vec3& direction, Vec3& u, Vec3& v) {
  u = direction.unitOrthogonal();
  v = direction.cross(u);
}

/// Improves a cylinder until it rests; gives its sum of squares.
double rest_cylinder(CylinderGuess& guess, const Points& points, const VertexScalars& weights) {
  constexpr int most_steps = 200;
  double damping = 1e-3;
  Eigen::VectorXd off = guess.residuals(points);
  double sum = off.cwiseAbs2().dot(weights);
  for (int round = 0; round < most_steps && damping < 1e12; ++round) {
    Vec3 u, v;
    across(guess.direction, u, v);
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const Vec3 p = points.row(i);
      const Vec3 outward = guess.from_axis(p).normalized();
      const double along = (p - guess.at).dot(guess.direction);
      Eigen::Matrix<double, 5, 1> slope;
      slope << -along * outward.dot(u), -along * outward.dot(v), -outward.dot(u), -outward.dot(v), -1;
      normal += weights[i] * slope * slope.transpose();
      right -= weights[i] * off[i] * slope;
    }
    normal.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, 5, 1> step = normal.ldlt().solve(right);
    if (!step.allFinite()) break;
    const CylinderGuess next = guess.moved(step, u, v);
    const Eigen::VectorXd next_off = next.residuals(points);
    const double next_sum = next_off.cwiseAbs2().dot(weights);
    if (!(next_sum <= sum)) {
      damping *= 10;
      continue;
    }
    guess = next;
    off = next_off;
    sum = next_sum;
    damping /= 10;
    if (step.norm() < 1e-13) break;
  }
  return sum;
}

}  // namespace

Result<FittedLine> fit_line(const Points& points, const VertexScalars& weights) {
  const auto spread = spread_of_points(points, weights, 2);
  if (!spread) return fail(spread.error());
  const Vec3 variances = spread->axes.eigenvalues();
  if (variances[2] - variances[1] <= 1e-6 * variances[2]) return fail("", "spreads alike in two directions");
  return FittedLine{spread->mean, spread->axes.eigenvectors().col(2),
                    std::sqrt(std::max(variances[0], 0.0) + std::max(variances[1], 0.0))};
}

Result<FittedPlane> fit_plane(const Points& points, const VertexScalars& weights) {
  const auto spread = spread_of_points(points, weights, 3);
  if (!spread) return fail(spread.error());
  if (spread->flat(1)) return fail("", "has all its points on a line");
  return FittedPlane{spread->mean, spread->axes.eigenvectors().col(0),
                     std::sqrt(std::max(spread->axes.eigenvalues()[0], 0.0))};
}

Result<FittedSphere> fit_sphere(const Points& points, const VertexScalars& weights) {
  const auto spread = spread_of_points(points, weights, 4);
  if (!spread) return fail(spread.error());
  if (spread->flat(0)) return fail("", "has all its points in a plane");
  const Points own = in_own_size(points, *spread);
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (Eigen::Index i = 0; i < own.rows(); ++i) {
    const Eigen::Vector4d row(2 * own(i, 0), 2 * own(i, 1), 2 * own(i, 2), 1);
    normal += weights[i] * row * row.transpose();
    right += weights[i] * own.row(i).squaredNorm() * row;
  }
  const Eigen::Vector4d algebraic = normal.ldlt().solve(right);
  Vec3 centre = algebraic.head<3>();
  double radius = std::sqrt(std::max(algebraic[3] + centre.squaredNorm(), 0.0));
  Eigen::VectorXd off(own.rows());
  constexpr int most_steps = 100;
  for (int round = 0; round < most_steps; ++round) {
    normal.setZero();
    right.setZero();
    for (Eigen::Index i = 0; i < own.rows(); ++i) {
      const Vec3 from = Vec3(own.row(i)) - centre;
      off[i] = from.norm() - radius;
      const Vec3 outward = from.normalized();
      const Eigen::Vector4d slope(-outward.x(), -outward.y(), -outward.z(), -1);
      normal += weights[i] * slope * slope.transpose();
      right -= weights[i] * off[i] * slope;
    }
    const Eigen::Vector4d step = normal.ldlt().solve(right);
    if (!step.allFinite()) return fail("", "does not determine a sphere");
    centre += step.head<3>();
    radius += step[3];
    if (step.norm() < 1e-13 * std::max(1.0, radius)) break;
  }
  if (!(radius > 0) || radius > 1e6) return fail("", "does not determine a sphere");
  const double size_mm = spread->size_mm();
  return FittedSphere{spread->mean + size_mm * centre, size_mm * radius, size_mm * weighed_rms(off, weights)};
}

Result<FittedCylinder> fit_cylinder(const Points& points, const VertexScalars& weights) {
  const auto spread = spread_of_points(points, weights, 6);
  if (!spread) return fail(spread.error());
  if (spread->flat(1)) return fail("", "has all its points on a line");
  const Points own = in_own_size(points, *spread);
  const VertexScalars shares = weights / spread->weight;
  std::optional<CylinderGuess> best;
  double least = 0;
  for (int axis = 2; axis >= 0; --axis) {
    CylinderGuess guess;
    guess.direction = spread->axes.eigenvectors().col(axis);
    guess.radius = 0;
    guess.radius = guess.residuals(own).dot(shares);
    const double sum = rest_cylinder(guess, own, shares);
    if (!std::isfinite(sum) || !(guess.radius > 0) || guess.radius > 1e3) continue;
    // A later start has to be clearly better, so that rounding does not choose.
    if (!best || sum < least * (1 - 1e-6) - 1e-20) best = guess, least = sum;
  }
  if (!best) return fail("", "does not determine a cylinder");
  const double size_mm = spread->size_mm();
  const Vec3 amid = best->at - best->at.dot(best->direction) * best->direction;
  return FittedCylinder{spread->mean + size_mm * amid, best->direction, size_mm * best->radius,
                        size_mm * std::sqrt(least)};
}

}  // namespace homolog
