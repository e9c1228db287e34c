#include "core/model/conditional.h"

#include <doctest/doctest.h>

#include "core/mesh/construction/icosphere.h"

using namespace homolog;

namespace {

constexpr Eigen::Index shapes_count = 7;

/// Balls whose landmarks vary at random, far less than the balls are large.
ShapeMatrix varied_balls() {
  std::srand(3);
  const Mesh ball = icosphere(1, 30);
  const Eigen::VectorXd middle = Eigen::Map<const Eigen::VectorXd>(ball.points.data(), ball.points.size());
  return (2 * ShapeMatrix::Random(middle.size(), shapes_count)).colwise() + middle;
}

ShapeModel varied_balls_model() {
  return make_model(principal_components(varied_balls()), 1, icosphere(1, 30).topology, {});
}

Points picked_rows(const Points& points, const std::vector<Eigen::Index>& rows) {
  Points seen_landmarks(std::ssize(rows), 3);
  for (Eigen::Index k = 0; k < seen_landmarks.rows(); ++k)
    seen_landmarks.row(k) = points.row(rows[static_cast<std::size_t>(k)]);
  return seen_landmarks;
}

const std::vector<Eigen::Index> seen_landmarks{0, 5, 11, 17, 23, 30, 41};

}  // namespace

TEST_CASE("a prediction from nothing is the mean with all of the model's spread") {
  const ShapeModel model = varied_balls_model();
  const Prediction prediction = predict(model, {}, Points(0, 3), 1);
  CHECK(prediction.b.norm() == 0);
  CHECK((prediction.points - points_of(model.mean)).norm() == 0);
  const Eigen::MatrixXd covariance = model.basis * model.variances.asDiagonal() * model.basis.transpose();
  for (Eigen::Index i = 0; i < 42; ++i)
    CHECK(prediction.deviation_mm[i] == doctest::Approx(std::sqrt(covariance.diagonal().segment(3 * i, 3).sum())));
}

TEST_CASE("a prediction is the conditional Gaussian of the full covariance") {
  const ShapeModel model = varied_balls_model();
  const double noise_mm = 0.7;
  const Points seen = picked_rows(points_of(varied_balls(), 2), seen_landmarks);
  const Prediction prediction = predict(model, seen_landmarks, seen, noise_mm);
  const Eigen::MatrixXd covariance = model.basis * model.variances.asDiagonal() * model.basis.transpose();
  const Eigen::Index n = model.mean.size(), m = 3 * std::ssize(seen_landmarks);
  Eigen::MatrixXd pick = Eigen::MatrixXd::Zero(m, n);
  for (Eigen::Index k = 0; k < m; ++k) pick(k, 3 * seen_landmarks[static_cast<std::size_t>(k / 3)] + k % 3) = 1;
  const Eigen::MatrixXd noisy =
      pick * covariance * pick.transpose() + noise_mm * noise_mm * Eigen::MatrixXd::Identity(m, m);
  const Eigen::MatrixXd gain = noisy.llt().solve(pick * covariance).transpose();
  const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(seen.data(), seen.size());
  const Eigen::VectorXd expected = model.mean + gain * (y - pick * model.mean);
  const Eigen::MatrixXd left = covariance - gain * pick * covariance;
  CHECK((Eigen::Map<const Eigen::VectorXd>(prediction.points.data(), n) - expected).norm() < 1e-9);
  for (Eigen::Index i = 0; i < n / 3; ++i)
    CHECK(prediction.deviation_mm[i] == doctest::Approx(std::sqrt(left.diagonal().segment(3 * i, 3).sum())));
}

TEST_CASE("a training shape is predicted from a few of its landmarks and noise leads to the mean") {
  const ShapeModel model = varied_balls_model();
  const Points shape = points_of(varied_balls(), 4);
  const Points seen = picked_rows(shape, seen_landmarks);
  CHECK((predict(model, seen_landmarks, seen, 1e-5).points - shape).norm() < 1e-4);
  CHECK((predict(model, seen_landmarks, seen, 1e6).points - points_of(model.mean)).norm() < 1e-6);
  double before = 0;
  for (const double noise_mm : {0.01, 1.0, 100.0}) {
    const double spread = predict(model, seen_landmarks, seen, noise_mm).deviation_mm.sum();
    CHECK(spread > before);
    before = spread;
  }
}

TEST_CASE("model help at strength 0 changes nothing and never moves what is known") {
  const ShapeModel model = varied_balls_model();
  const ShapeModel posed = with_pose(model);
  ShapeSolver solver(model.topology);
  const VertexScalars stiffness = VertexScalars::Constant(42, 10);
  const Points shape = points_of(varied_balls(), 1) * 1.3;
  VertexScalars known = VertexScalars::Zero(42);
  for (const Eigen::Index i : seen_landmarks) known[i] = 1;
  CHECK(completed(posed, shape, known, 0.5, 0, stiffness, solver)->points == shape);
  const Points half = completed(posed, shape, known, 0.5, 0.5, stiffness, solver)->points;
  const Points full = completed(posed, shape, known, 0.5, 1, stiffness, solver)->points;
  for (const Eigen::Index i : seen_landmarks) CHECK(full.row(i) == shape.row(i));
  CHECK((half - (shape + full) / 2).norm() < 1e-9);
  CHECK((full - shape).norm() > 0.1);
  CHECK(!completed(posed, shape.topRows(20), known.head(20), 0.5, 1, stiffness, solver));
}

TEST_CASE("model help completes a shape of the model from what is known wherever it lies") {
  const ShapeModel model = varied_balls_model();
  const ShapeModel posed = with_pose(model);
  ShapeSolver solver(model.topology);
  const Points truth = points_of(varied_balls(), 5);
  const Similarity elsewhere{Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Vec3(1, 2, 2) / 3)), 1.5, Vec3(10, -20, 300)};
  // The rest still lies where the model's mean puts it.
  Points begun = points_of(model.mean);
  VertexScalars known = VertexScalars::Zero(42);
  for (const Eigen::Index i : seen_landmarks) {
    begun.row(i) = truth.row(i);
    known[i] = 1;
  }
  const Points there = elsewhere.apply(begun);
  const auto help = completed(posed, there, known, 0.1, 1, VertexScalars::Constant(42, 10), solver);
  REQUIRE(help);
  const double before_mm = (there - elsewhere.apply(truth)).rowwise().norm().mean();
  CHECK((help->points - elsewhere.apply(truth)).rowwise().norm().mean() < 0.5 * before_mm);
}
