#include "core/model/conditional.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/base/demand.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

/// √ of the summed posterior variances of each vertex's coordinates: rows of Φ A with A Aᵀ the posterior of b.
VertexScalars deviations(const Eigen::MatrixXd& spread) {
  VertexScalars result(spread.rows() / 3);
  for (Eigen::Index i = 0; i < result.size(); ++i) result[i] = spread.middleRows(3 * i, 3).norm();
  return result;
}

// How far a shape may be from where the model's mean lies on it as a whole (standard deviations).
constexpr double shift_share = 0.03;  // along each axis, of the shape's extent
constexpr double turn_rad = 0.09;     // 5°, about each axis
constexpr double size_share = 0.05;

}  // namespace

Prediction predict(const ShapeModel& model, const std::vector<Eigen::Index>& landmarks, const Points& positions,
                   double noise_mm) {
  demand(positions.rows() == std::ssize(landmarks),
         "there are other positions than landmarks; give a position of each landmark");
  demand(noise_mm > 0, "positions without noise cannot be weighed against the model; give a noise above 0 mm");
  for (const Eigen::Index vertex : landmarks)
    demand(vertex >= 0 && vertex < model.mean.size() / 3,
           "the model has no such vertex; give landmarks by its numbers, counted from 0");
  const Eigen::Index modes = model.modes();
  const double variance = noise_mm * noise_mm + model.noise_variance;
  // In units of √λ, where the prior is the identity: no division by a λ that is next to nothing.
  const Eigen::VectorXd deviation = model.variances.cwiseSqrt();
  Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(modes, modes);
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(modes);
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    const Eigen::Index row = 3 * landmarks[k];
    const Eigen::MatrixXd part = model.basis.middleRows(row, 3) * deviation.asDiagonal();
    precision += part.transpose() * part / variance;
    seen += part.transpose() * (positions.row(k).transpose() - model.mean.segment(row, 3)) / variance;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(precision);
  Prediction prediction;
  prediction.b = deviation.cwiseProduct(factor.solve(seen));
  prediction.points = shape_of(model, prediction.b);
  // The posterior covariance of b/√λ is (L Lᵀ)⁻¹, so its root is L⁻ᵀ.
  const Eigen::MatrixXd root = factor.matrixU().solve(Eigen::MatrixXd::Identity(modes, modes));
  prediction.deviation_mm = deviations(model.basis * (deviation.asDiagonal() * root));
  return prediction;
}

ShapeModel with_pose(const ShapeModel& model) {
  const Points mean = points_of(model.mean);
  const Eigen::RowVector3d centre = mean.colwise().mean();
  const double extent = bounds_of(mean).diagonal().norm();
  ShapeModel posed;
  posed.mean = model.mean;
  posed.noise_variance = model.noise_variance;
  posed.basis.resize(model.basis.rows(), model.modes() + 7);
  posed.basis.leftCols(model.modes()) = model.basis;
  posed.variances.resize(model.modes() + 7);
  posed.variances.head(model.modes()) = model.variances;
  const auto add = [&](Eigen::Index k, const Points& moves, double deviation) {
    const double length = moves.norm();
    posed.basis.col(model.modes() + k) = Eigen::Map<const Eigen::VectorXd>(moves.data(), moves.size()) / length;
    posed.variances[model.modes() + k] = std::pow(deviation * length, 2);
  };
  const Points arms = mean.rowwise() - centre;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::RowVector3d unit = Eigen::RowVector3d::Unit(axis);
    add(axis, unit.replicate(mean.rows(), 1), shift_share * extent);
    add(3 + axis, arms.rowwise().cross(unit), turn_rad);
  }
  add(6, arms, size_share);
  return posed;
}

Result<Completion> completed(const ShapeModel& posed, const Points& shape, const VertexScalars& known, double noise_mm,
                             double strength, const VertexScalars& stiffness, ShapeSolver& solver) {
  const Points mean = points_of(posed.mean);
  if (mean.rows() != shape.rows())
    return fail("model", "has " + std::to_string(mean.rows()) + " vertices where the shape has " +
                             std::to_string(shape.rows()) + "; both must come from one template");
  const Similarity pose = nearest_similarity(mean, shape, Similarity{});
  std::vector<Eigen::Index> landmarks;
  for (Eigen::Index i = 0; i < known.size(); ++i)
    if (known[i] > 0) landmarks.push_back(i);
  Points positions(std::ssize(landmarks), 3);
  for (Eigen::Index k = 0; k < positions.rows(); ++k) positions.row(k) = shape.row(landmarks[k]);
  const Prediction prediction = predict(posed, landmarks, pose.inverse().apply(positions), noise_mm / pose.scale);
  const Points expected = pose.apply(shape_of(posed, clamped(posed, prediction.b)));
  const VertexScalars hold = firm_hold(*solver.topology(), stiffness, known);
  if (auto ready = solver.factorise(stiffness, hold); !ready) return fail(ready.error());
  const Points reached = expected + solver.solve(Points(hold.asDiagonal() * (shape - expected)));
  const VertexScalars share = strength * (1 - known.array()).max(0);
  return Completion{shape + share.asDiagonal() * (reached - shape), pose.scale * prediction.deviation_mm};
}

}  // namespace homolog
