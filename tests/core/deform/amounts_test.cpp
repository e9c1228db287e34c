#include <doctest/doctest.h>

#include <cmath>

#include "core/deform/deformer.h"
#include "core/deform/falloff.h"
#include "core/deform/surface_walk.h"
#include "core/deform/tangential.h"
#include "core/mesh/mesh_quality.h"
#include "tests/shapes.h"

// Where a gesture goes and how far: figures that are known beforehand.

namespace homolog {

namespace {

const Mesh pulled_ball = icosphere(4, 40);
const Vec3 ball_top(0, 0, 40);

StrokeStart at_rest(const Mesh& mesh) {
  StrokeStart start;
  start.topology = mesh.topology;
  start.placed = start.reference = start.points = std::make_shared<const Points>(mesh.points);
  start.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(mesh.points.rows()));
  start.stiffness_base = 10;
  return start;
}

Stroke stroke_by(Tool tool, const Vec3& at, const Vec3& to, double sigma_mm = 8) {
  return {tool, at, to, sigma_mm, {}, false, 1};
}

StrokeOutcome outcome_of(const StrokeStart& start, const Stroke& stroke) {
  return Deformer().stroke(start, stroke, Pass::commit).value();
}

/// The ball with a bump of 12 mm beside its top.
StrokeStart with_bump() {
  StrokeStart start = at_rest(pulled_ball);
  start.points = std::make_shared<const Points>(
      outcome_of(start, stroke_by(Tool::grab, ball_top, ball_top + Vec3(4, 0, 12), 5)).points);
  return start;
}

/// How unevenly edges near the top are stretched: the deviation of their lengths over those at rest.
double unevenness(const Points& points) {
  double sum = 0, squares = 0, count = 0;
  for (const auto& [i, j] : pulled_ball.topology->edges()) {
    if ((pulled_ball.points.row(i).transpose() - ball_top).norm() > 15) continue;
    const double stretch =
        (points.row(i) - points.row(j)).norm() / (pulled_ball.points.row(i) - pulled_ball.points.row(j)).norm();
    sum += stretch;
    squares += stretch * stretch;
    ++count;
  }
  return std::sqrt(squares / count - sum * sum / count / count);
}

}  // namespace

TEST_CASE("the falloff is a Gaussian of its deviation and never narrower than half an edge") {
  const Topology& topology = *pulled_ball.topology;
  const std::int32_t corner = topology.triangles()(7, 0);
  const SurfacePoint there{7, Vec3(1, 0, 0)};
  const auto falls = [&](double sigma_mm, double deviation_mm) {
    const VertexScalars g = gaussian_falloff(topology, pulled_ball.points, there, sigma_mm, 3, false);
    for (Eigen::Index i = 0; i < g.size(); i += 50) {
      const double away_mm = (pulled_ball.points.row(i) - pulled_ball.points.row(corner)).norm();
      CHECK(g[i] == doctest::Approx(std::exp(-0.5 * std::pow(away_mm / deviation_mm, 2))));
    }
    CHECK(g[corner] == 1);
  };
  falls(12, 12);
  falls(1.6, 1.6);
  falls(0.1, 1.5);
}

TEST_CASE("Slide brings the grabbed place to where the pointer is") {
  const StrokeStart start = at_rest(pulled_ball);
  const SurfacePoint grabbed = SurfaceSearch(pulled_ball).nearest(ball_top).at;
  for (const Vec3& way : {Vec3(6, 0, 0), Vec3(0, -5, 0), Vec3(-3, 4, 0)}) {
    const Vec3 from = grabbed.interpolate(*pulled_ball.topology, pulled_ball.points).transpose();
    const auto outcome = outcome_of(start, stroke_by(Tool::slide, ball_top, from + way));
    const Vec3 came = grabbed.interpolate(*pulled_ball.topology, outcome.points).transpose();
    CHECK((came - (from + way)).norm() < 0.25 * way.norm());
    CHECK((came - from).dot(way) > 0.8 * way.squaredNorm());
  }
}

TEST_CASE("even spacing evens the lengths of edges out") {
  StrokeStart start = with_bump();
  const Vec3 at = SurfaceSearch({pulled_ball.topology, *start.points}).nearest(Vec3(0, 0, 60)).position;
  const auto after = [&](double spacing) {
    start.even_spacing = spacing;
    return unevenness(outcome_of(start, stroke_by(Tool::grab, at, at + Vec3(0, 0, 2))).points);
  };
  const double without = after(0);
  CHECK(after(0.25) < 0.99 * without);
  CHECK(after(1) < 0.97 * without);
}

TEST_CASE("Relax moves in proportion to its strength and leaves what is confirmed") {
  StrokeStart start = with_bump();
  Stroke dab = stroke_by(Tool::relax, Vec3(0, 0, 50), Vec3(0, 0, 50), 15);
  const auto moves = [&](double strength) {
    dab.strength = strength;
    const auto outcome = outcome_of(start, dab);
    REQUIRE_FALSE(outcome.stopped_by_guard);
    return Points(outcome.points - *start.points);
  };
  const Points whole = moves(1);
  CHECK(whole.rowwise().norm().maxCoeff() > 1);
  CHECK(largest_difference(moves(0.25), 0.25 * whole) < 1e-9);
  const VertexScalars confirmed = (pulled_ball.points.col(0).array() > 0).cast<double>();
  start.confirmed = std::make_shared<const VertexScalars>(confirmed);
  const Points beside = moves(1);
  CHECK((confirmed.asDiagonal() * beside).cwiseAbs().maxCoeff() == 0);
  CHECK(beside.rowwise().norm().maxCoeff() > 0.5);
}

TEST_CASE("a place is held from half of confirmed on") {
  StrokeStart start = at_rest(pulled_ball);
  const auto moves = [&](double confirmed) {
    start.confirmed =
        std::make_shared<const VertexScalars>(VertexScalars::Constant(pulled_ball.points.rows(), confirmed));
    return Deformer().stroke(start, stroke_by(Tool::grab, ball_top, ball_top * 1.05), Pass::commit).has_value();
  };
  CHECK(moves(0.45));
  CHECK_FALSE(moves(0.55));
  CHECK_FALSE(moves(1));
}

TEST_CASE("what is left along a surface has no part across it") {
  const Points normals = vertex_normals(pulled_ball);
  const Points offset = Points::Zero(normals.rows(), 3).rowwise() + Eigen::RowVector3d(1, -2, 3);
  const Points along = tangential(pulled_ball, offset), across = offset - along;
  for (Eigen::Index i = 0; i < along.rows(); i += 20) {
    CHECK(std::abs(along.row(i).dot(normals.row(i))) < 1e-12);
    CHECK(across.row(i).cross(normals.row(i)).norm() < 1e-12);
  }
}

TEST_CASE("a walk over the surface ends near the nearest point") {
  const Topology& topology = *pulled_ball.topology;
  const SurfaceSearch search(pulled_ball);
  const SurfacePoint start = search.nearest(ball_top).at;
  for (const Vec3& to : {Vec3(5, 2, 41), Vec3(20, 10, 30), Vec3(-38, 0, 9), Vec3(2, -30, 20)})
    CHECK((walk_to_nearest(topology, pulled_ball.points, start, to).position - search.nearest(to).position).norm() <
          0.1);
}

TEST_CASE("strokes whose numbers are out of range are refused and those at its ends are not") {
  const StrokeStart start = at_rest(pulled_ball);
  Stroke dab = stroke_by(Tool::relax, ball_top, ball_top, 15);
  const auto taken = [&](double strength, double sigma_mm) {
    dab.strength = strength;
    dab.sigma_mm = sigma_mm;
    return Deformer().stroke(start, dab, Pass::commit).has_value();
  };
  CHECK(taken(0, 15));
  CHECK(taken(1, 15));
  CHECK_FALSE(taken(1.01, 15));
  CHECK_FALSE(taken(-0.01, 15));
  CHECK_FALSE(taken(0.5, 0));
  CHECK_FALSE(taken(0.5, -1));
}

TEST_CASE("one event of the paper's scheme pushes by the Gaussian and solves") {
  StrokeStart start = at_rest(pulled_ball);
  start.scheme = Scheme::paper;
  const Stroke push = stroke_by(Tool::grab, ball_top, ball_top + Vec3(1, -2, 5), 8);
  const auto outcome = outcome_of(start, push);
  const auto grabbed = SurfaceSearch(pulled_ball).nearest(ball_top);
  const VertexScalars g = gaussian_falloff(*pulled_ball.topology, pulled_ball.points, grabbed.at, 8,
                                           mean_edge_mm(*pulled_ball.topology, pulled_ball.points), false);
  ShapeSolver solver(pulled_ball.topology);
  REQUIRE(solver.factorise(start.stiffness_base * *start.stiffness));
  const Points expected = solver.solve(Points(g * (push.to - grabbed.position).transpose()));
  CHECK(largest_difference(outcome.points - pulled_ball.points, expected) < 1e-9);
}

}  // namespace homolog
