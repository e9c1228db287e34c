#include "core/model/conditional.h"

#include <Eigen/Cholesky>
#include <cassert>

#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

/// Force of a known landmark towards its place, against 1 of every other towards the prediction.
constexpr double hold_weight = 1e4;

/// √ of the summed posterior variances of each landmark's coordinates: rows of Φ A with A Aᵀ the posterior of b.
VertexScalars deviations(const Eigen::MatrixXd& spread) {
  VertexScalars result(spread.rows() / 3);
  for (Eigen::Index i = 0; i < result.size(); ++i) result[i] = spread.middleRows(3 * i, 3).norm();
  return result;
}

}  // namespace

Prediction predict(const ShapeModel& model, const std::vector<Eigen::Index>& landmarks, const Points& positions,
                   double noise_mm) {
  assert(positions.rows() == std::ssize(landmarks) && noise_mm > 0);
  const Eigen::Index modes = model.modes();
  const double variance = noise_mm * noise_mm + model.noise_variance;
  // In units of √λ, where the prior is the identity: no division by a λ that is next to nothing.
  const Eigen::VectorXd deviation = model.variances.cwiseSqrt();
  Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(modes, modes);
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(modes);
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    const Eigen::Index row = 3 * landmarks[static_cast<std::size_t>(k)];
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

Result<Completion> completed(const ShapeModel& model, const Points& shape, const VertexScalars& known, double noise_mm,
                             double strength, const VertexScalars& stiffness, ShapeSolver& solver) {
  const Points mean = points_of(model.mean);
  if (mean.rows() != shape.rows())
    return fail("model", "has " + std::to_string(mean.rows()) + " landmarks where the shape has " +
                             std::to_string(shape.rows()) + "; both must come from one template");
  const Similarity pose = fit_similarity(mean, shape, Similarity{});
  std::vector<Eigen::Index> landmarks;
  for (Eigen::Index i = 0; i < known.size(); ++i)
    if (known[i] > 0) landmarks.push_back(i);
  Points positions(std::ssize(landmarks), 3);
  for (Eigen::Index k = 0; k < positions.rows(); ++k)
    positions.row(k) = shape.row(landmarks[static_cast<std::size_t>(k)]);
  const Prediction prediction = predict(model, landmarks, pose.inverse().apply(positions), noise_mm / pose.scale);
  const Points expected = pose.apply(prediction.points);
  const VertexScalars hold = hold_weight * known;
  if (auto ready = solver.factorise(stiffness, hold); !ready) return fail(ready.error());
  const Points reached = expected + solver.solve(Points(hold.asDiagonal() * (shape - expected)));
  const VertexScalars share = strength * (1 - known.array()).max(0);
  return Completion{shape + share.asDiagonal() * (reached - shape), pose.scale * prediction.deviation_mm};
}

}  // namespace homolog
