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
