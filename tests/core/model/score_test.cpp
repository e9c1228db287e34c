#include "core/model/score.h"

#include <doctest/doctest.h>

#include "core/mesh/icosphere.h"
#include "tests/must.h"

using namespace homolog;

namespace {

constexpr Eigen::Index training = 60;

/// Balls that vary in two ways, 2 mm and 1 mm, and a little in every coordinate.
ShapeModel ball_model() {
  const Mesh ball = icosphere(2, 30);
  const Eigen::Index rows = ball.points.size();
  const Eigen::VectorXd mean = Eigen::Map<const Eigen::VectorXd>(ball.points.data(), rows);
  std::srand(11);
  ShapeMatrix shapes = 0.05 * ShapeMatrix::Random(rows, training);
  for (Eigen::Index k = 0; k < training; ++k) {
    const Eigen::Vector2d b = Eigen::Vector2d::Random();
    for (Eigen::Index v = 0; v < rows / 3; ++v) {
      const Vec3 p = ball.points.row(v).transpose();
      shapes.col(k).segment<3>(3 * v) += p + p / 30 * (2 * b[0] * p.x() / 30 + b[1] * p.y() * p.z() / 450);
    }
  }
  ShapeModel model = make_model(principal_components(std::move(shapes)), 0.9, ball.topology, {});
  model.alignment = Alignment::none;
  return model;
}

Points plus_modes(const ShapeModel& model, double first, double second) {
  return shape_of(model,
                  Eigen::Vector2d(first * std::sqrt(model.variances[0]), second * std::sqrt(model.variances[1])));
}

}  // namespace

TEST_CASE("a shape that modes make has their coordinates, and nothing beyond") {
  const ShapeModel model = ball_model();
  REQUIRE(model.modes() == 2);
  const ShapeScore score = test::must(score_shape(model, plus_modes(model, 1.5, -2)));
  CHECK(score.modes[0] == doctest::Approx(1.5));
  CHECK(score.modes[1] == doctest::Approx(-2));
  CHECK(score.distance == doctest::Approx(2.5));
  CHECK(score.residual_mm < 1e-9);
  REQUIRE(score.percentile);
  CHECK(*score.percentile > 95);
  const ShapeScore mean = test::must(score_shape(model, points_of(model.mean)));
  CHECK(mean.distance < 1e-9);
  CHECK(mean.z.cwiseAbs().maxCoeff() < 1e-9);
  CHECK(*mean.percentile == 0);
}

TEST_CASE("a bump that no mode knows lies beyond the model, and stands out where it is") {
  const ShapeModel model = ball_model();
  Points shape = points_of(model.mean);
  shape.row(7) *= 32.0 / 30;
  const ShapeScore score = test::must(score_shape(model, shape));
  CHECK(score.residual_mm * std::sqrt(static_cast<double>(shape.rows())) == doctest::Approx(2).epsilon(0.1));
  Eigen::Index most = 0;
  score.z.maxCoeff(&most);
  CHECK(most == 7);
  CHECK(score.z_low[7] < score.z[7]);
  CHECK(score.z_high[7] > score.z[7]);
  Points inward = points_of(model.mean);
  inward.row(7) *= 28.0 / 30;
  CHECK(test::must(score_shape(model, inward)).z[7] == doctest::Approx(-score.z[7]).epsilon(0.01));
}

TEST_CASE("z has the spread of the training shapes") {
  const ShapeModel model = ball_model();
  const double vertices = static_cast<double>(model.mean.size()) / 3;
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed)
    squares += test::must(score_shape(model, sampled_shape(model, seed))).z.squaredNorm() / vertices;
  // All but the noise beside the modes, which sampled shapes lack.
  CHECK(squares / 200 > 0.7);
  CHECK(squares / 200 < 1.1);
}

TEST_CASE("a vertex in doubt says less") {
  const ShapeModel model = ball_model();
  Points shape = plus_modes(model, 1, 0);
  shape.row(7) *= 34.0 / 30;
  VertexScalars doubt_mm = VertexScalars::Zero(shape.rows());
  doubt_mm[7] = 8;
  const ShapeScore sure = test::must(score_shape(model, shape));
  const ShapeScore doubted = test::must(score_shape(model, shape, doubt_mm));
  CHECK(doubted.z[7] < sure.z[7] / 3);
  CHECK(doubted.z_high[7] - doubted.z_low[7] > 2 * (sure.z_high[7] - sure.z_low[7]));
  CHECK(std::abs(doubted.modes[0] - 1) < std::abs(sure.modes[0] - 1) / 3);
}

TEST_CASE("the distance of a training shape that is left out is that of the model of the others") {
  const ShapeModel model = ball_model();
  const auto distances = left_out_distances(model);
  REQUIRE(std::ssize(distances) == training);
  for (const Eigen::Index out : {0, 17, 59}) {
    Eigen::MatrixXd others(2, training - 1);
    for (Eigen::Index k = 0, to = 0; k < training; ++k)
      if (k != out) others.col(to++) = model.scores.col(k);
    const Eigen::Vector2d mean = others.rowwise().mean();
    others.colwise() -= mean;
    const Eigen::Matrix2d covariance = others * others.transpose() / static_cast<double>(training - 2);
    const Eigen::Vector2d off = model.scores.col(out) - mean;
    CHECK(distances[static_cast<std::size_t>(out)] ==
          doctest::Approx(std::sqrt(off.dot(covariance.inverse() * off))).epsilon(1e-9));
  }
}

TEST_CASE("a shape of another size or place scores the same where the model was aligned") {
  ShapeModel model = ball_model();
  model.alignment = Alignment::similarity;
  Points shape = plus_modes(model, 1, 1);
  const ShapeScore here = test::must(score_shape(model, shape));
  Similarity away;
  away.scale = 1.3;
  away.translation = Vec3(40, -7, 12);
  away.rotation = Eigen::AngleAxisd(0.6, Vec3(1, 2, 2) / 3);
  const ShapeScore there = test::must(score_shape(model, away.apply(shape)));
  CHECK(there.distance == doctest::Approx(here.distance).epsilon(1e-6));
  CHECK((there.z - here.z).cwiseAbs().maxCoeff() < 1e-6);
  CHECK(there.size_mm == doctest::Approx(1.3 * here.size_mm));
}

TEST_CASE("a shape of another numbering is refused with both counts") {
  const ShapeModel model = ball_model();
  const auto score = score_shape(model, Points::Zero(10, 3));
  REQUIRE_FALSE(score);
  CHECK(score.error().what.find("10 vertices and the model 162") != std::string::npos);
}
