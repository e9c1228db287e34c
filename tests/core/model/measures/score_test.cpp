#include "core/model/measures/score.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/mesh/construction/icosphere.h"
#include "core/model/measures/leave_one_out.h"
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
  const auto components = principal_components(std::move(shapes));
  ShapeModel model = make_model(components, 0.9, ball.topology, {});
  model.left_out_distances = left_out_distances(components, model.modes());
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

TEST_CASE("a training shape has the coordinates that it has in the model, whose shapes were brought to one size") {
  const Mesh ball = icosphere(2, 30);
  ShapeMatrix shapes(ball.points.size(), 12);
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    const double wide = 5 * std::sin(1.7 * static_cast<double>(k)), high = 3 * std::cos(2.9 * static_cast<double>(k));
    for (Eigen::Index v = 0; v < ball.points.rows(); ++v) {
      const Vec3 p = ball.points.row(v).transpose();
      shapes.col(k).segment<3>(3 * v) =
          (1 + 0.02 * static_cast<double>(k)) * (p + p / 30 * (wide * p.x() / 30 + high * p.y() * p.z() / 450));
    }
  }
  const ShapeMatrix raw = shapes;
  align(shapes, Alignment::similarity);
  ShapeModel model = make_model(principal_components(std::move(shapes)), 1, ball.topology, {});
  model.alignment = Alignment::similarity;
  for (Eigen::Index k = 0; k < raw.cols(); ++k) {
    const ShapeScore score = test::must(score_shape(model, points_of(raw, k)));
    const Eigen::VectorXd own = model.scores.col(k).cwiseQuotient(model.variances.cwiseSqrt());
    CHECK((score.modes - own).cwiseAbs().head(2).maxCoeff() < 1e-6);
    CHECK(score.residual_mm < 1e-6);
  }
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

TEST_CASE("with size taken out a shape and its doubt may be of any size") {
  ShapeModel model = ball_model();
  const Points shape = plus_modes(model, 1, -1);
  VertexScalars doubt_mm = VertexScalars::LinSpaced(shape.rows(), 0, 3);
  model.alignment = Alignment::similarity;
  const ShapeScore whole = test::must(score_shape(model, shape, doubt_mm));
  const ShapeScore half = test::must(score_shape(model, 0.5 * shape, 0.5 * doubt_mm));
  CHECK(half.distance == doctest::Approx(whole.distance).epsilon(1e-9));
  CHECK(half.all.z_rms == doctest::Approx(whole.all.z_rms).epsilon(1e-9));
  CHECK(half.z_high[9] == doctest::Approx(whole.z_high[9]).epsilon(1e-9));
  CHECK(whole.distance !=
        doctest::Approx(test::must(score_shape(model, shape, 0.5 * doubt_mm)).distance).epsilon(1e-4));
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
  // What is certain of the one may be nothing of the other; in its own units the interval never counts more than 1.
  CHECK(sure.z_low[7] > 0);
  CHECK(doubted.z_low[7] < 0);
  doubt_mm[7] = 1e6;
  const ShapeScore unknown = test::must(score_shape(model, shape, doubt_mm));
  CHECK(unknown.z_high[7] - unknown.z_low[7] < 2 * 1.96 * std::sqrt(1 + 1 / 2.0));
  CHECK(std::abs(doubted.modes[0] - 1) < std::abs(sure.modes[0] - 1) / 3);
}

namespace {

/// Shapes that vary in many ways, each of which varies less than the one before. They need no mesh to mean something.
ShapeMatrix many_ways(Eigen::Index shapes, unsigned seed) {
  constexpr Eigen::Index rows = 3 * 162;
  Eigen::VectorXd deviations(rows);
  for (Eigen::Index row = 0; row < rows; ++row) deviations[row] = 2 * std::pow(0.93, static_cast<double>(row));
  return deviations.asDiagonal() * sampled_coefficients(Eigen::VectorXd::Ones(rows), shapes, seed);
}

}  // namespace

TEST_CASE("the distance of a training shape that is left out is that of the model that the others make") {
  constexpr Eigen::Index shapes = 12, modes = 4;
  const ShapeMatrix all = many_ways(shapes, 3);
  const Eigen::VectorXd distances = left_out_distances(principal_components(all), modes);
  REQUIRE(distances.size() == shapes);
  for (const Eigen::Index out : {0, 5, 11}) {
    ShapeMatrix others(all.rows(), shapes - 1);
    others << all.leftCols(out), all.rightCols(shapes - 1 - out);
    const auto components = principal_components(others);
    const Eigen::VectorXd b = components.basis(modes).transpose() * (all.col(out) - components.mean);
    const Eigen::VectorXd variances = components.variances().head(modes);
    const double distance = std::sqrt((b.array().square() / variances.array()).sum());
    CHECK(distances[out] == doctest::Approx(distance).epsilon(1e-9));
  }
}

TEST_CASE("new subjects are as far from the model as training shapes that are left out") {
  const Mesh ball = icosphere(2, 30);
  double percentiles = 0;
  int count = 0;
  for (unsigned draw = 0; draw < 20; ++draw) {
    const ShapeMatrix all = many_ways(30, 100 + draw);
    const auto components = principal_components(all.leftCols(20));
    ShapeModel model = make_model(components, 0.95, ball.topology, {});
    model.left_out_distances = left_out_distances(components, model.modes());
    model.alignment = Alignment::none;
    for (Eigen::Index k = 20; k < all.cols(); ++k) {
      percentiles += *test::must(score_shape(model, points_of(all, k))).percentile;
      ++count;
    }
  }
  CHECK(percentiles / count > 44);
  CHECK(percentiles / count < 56);
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
