#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/adapt/match/surface_samples.h"
#include "core/mesh/mesh_quality.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

SurfaceSamples samples_of(const Mesh& mesh, const std::vector<Eigen::Index>& vertices) {
  return samples_of(mesh, vertex_normals(mesh), vertices);
}

SurfaceSamples all_samples_of(const Mesh& mesh) {
  return samples_of(mesh, stepped_vertices(mesh.points.rows(), mesh.points.rows()));
}

/// The largest angle between rows, both n×3 and unit, as the length of their difference.
double farthest_turn(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

}  // namespace

TEST_CASE("samples share the area of the surface: where they lie dense, each stands for less") {
  const Mesh ball = icosphere(4, 20);
  std::vector<Eigen::Index> vertices;  // all of the upper half, every fourth of the lower one
  for (Eigen::Index v = 0; v < ball.points.rows(); ++v)
    if (ball.points(v, 2) > 0 || v % 4 == 0) vertices.push_back(v);
  const SurfaceSamples samples = samples_of(ball, vertices);
  CHECK(samples.area_mm2.sum() == doctest::Approx(surface_area_mm2(ball)).epsilon(1e-4));
  double upper = 0;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i)
    if (samples.points(i, 2) > 0) upper += samples.area_mm2[i];
  CHECK(upper / surface_area_mm2(ball) == doctest::Approx(0.5).epsilon(0.1));
}

TEST_CASE("the first of the spread vertices are spread, too") {
  const Mesh ball = icosphere(4, 20);
  const auto spread = spread_vertices(ball.points, 200);
  for (const std::size_t count : {50U, 200U}) {
    const Points picked = ball.points(std::vector(spread.begin(), spread.begin() + count), Eigen::all);
    double farthest_mm = 0;
    for (const auto& p : ball.points.rowwise())
      farthest_mm = std::max(farthest_mm, (picked.rowwise() - p).rowwise().norm().minCoeff());
    // A disc for each of `count` points, 1.6 times as large as an even share of the ball.
    CHECK(farthest_mm < 1.6 * std::sqrt(surface_area_mm2(ball) / (std::numbers::pi * static_cast<double>(count))));
  }
}

TEST_CASE("samples of a surface that moved a little are drawn back to it") {
  const Mesh ball = icosphere(4, 20);
  SurfaceSamples own = samples_of(ball, spread_vertices(ball.points, 400));
  const SurfaceSamples there = samples_of(ball, stepped_vertices(ball.points.rows(), 800));
  own.points *= 1.05;
  const DrawnSamples found = drawn(own, there, 2, 2);
  CHECK(found.weights.minCoeff() > 0);
  const Eigen::VectorXd radii = found.targets.rowwise().norm();
  CHECK(radii.mean() == doctest::Approx(20).epsilon(0.01));
}

TEST_CASE("a sample without anything near it is believed next to nothing") {
  const Mesh ball = icosphere(4, 20);
  SurfaceSamples own = samples_of(ball, spread_vertices(ball.points, 100));
  const SurfaceSamples there = samples_of(ball, stepped_vertices(ball.points.rows(), 800));
  own.points.row(7) *= 3;
  const DrawnSamples found = drawn(own, there, 1, 2);
  CHECK(found.weights[7] < 0.01 * found.weights.mean());
}

TEST_CASE("smooth normals leave out ripples and keep the shape") {
  Mesh ball = icosphere(5, 20);
  for (auto p : ball.points.rowwise()) p *= 1 + 0.01 * std::sin(1.5 * p.x()) * std::sin(1.5 * p.y());
  const SurfaceSamples rippled = all_samples_of(ball);
  const Points shape = rippled.points.rowwise().normalized();
  const double before = farthest_turn(rippled.normals, shape);
  CHECK(before > 0.2);
  CHECK(farthest_turn(smooth_normals(rippled, 4), shape) < 0.2 * before);
}

TEST_CASE("smooth normals of a thin plate do not mix its two sides") {
  Mesh plate = icosphere(4, 20);
  plate.points.col(2) *= 0.05;
  const SurfaceSamples samples = all_samples_of(plate);
  const Points smooth = smooth_normals(samples, 4);
  for (Eigen::Index i = 0; i < smooth.rows(); ++i)
    if (std::abs(samples.normals(i, 2)) > 0.9) CHECK(smooth(i, 2) * samples.normals(i, 2) > 0.8);
}

TEST_CASE("a place goes to where the surface faces as it does") {
  const Mesh ball = icosphere(5, 20);
  const SurfaceSamples there = all_samples_of(ball);
  const double turn = 0.05;  // 1 mm on the ball
  const Points true_place = (Points(1, 3) << 20 * std::sin(turn), 0, 20 * std::cos(turn)).finished(),
               place = (Points(1, 3) << 0, 0, 20).finished();
  const LocatedSamples found = located(place, true_place / 20, there, 2, 30);
  CHECK(found.known[0] > 1);
  CHECK((found.targets - true_place).norm() < 0.25);
}

TEST_CASE("a place with nothing near it, or nothing that faces as it does, stays and is not known") {
  const SurfaceSamples there = all_samples_of(icosphere(4, 20));
  const Points up = Eigen::RowVector3d(0, 0, 1), down = Eigen::RowVector3d(0, 0, -1);
  const Points off = Eigen::RowVector3d(0, 0, 40), pole = Eigen::RowVector3d(0, 0, 20);
  const auto far = located(off, up, there, 2, 8), against = located(pole, down, there, 2, 8);
  CHECK(far.known[0] == 0);
  CHECK(far.targets == off);
  CHECK(against.known[0] == 0);
  CHECK(against.targets == pole);
}
