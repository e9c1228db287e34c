#include "core/deform/gesture.h"
#include "core/deform/local_rotations.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/deform/deformer.h"
#include "core/deform/falloff.h"
#include "core/deform/tangential.h"
#include "core/mesh/mesh_quality.h"
#include "core/solve/energy.h"
#include "tests/shapes.h"
#include "tests/thread_limit.h"

using namespace homolog;

namespace {

std::shared_ptr<const Points> share(Points points) {
  return std::make_shared<const Points>(std::move(points));
}

StrokeStart start_of(const Mesh& mesh, double stiffness = 10) {
  StrokeStart start;
  start.topology = mesh.topology;
  start.placed = start.reference = start.points = share(mesh.points);
  start.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(mesh.points.rows()));
  start.stiffness_base = stiffness;
  return start;
}

Stroke drag(Tool tool, const Vec3& at, const Vec3& to, double sigma_mm = 8) {
  Stroke stroke;
  stroke.tool = tool;
  stroke.at = at;
  stroke.to = to;
  stroke.sigma_mm = sigma_mm;
  return stroke;
}

StrokeOutcome made(const StrokeStart& start, const Stroke& stroke) {
  return Deformer().stroke(start, stroke, Pass::commit).value();
}

const Mesh big_ball = icosphere(4, 40);
const Vec3 big_pole(0, 0, 40);

}  // namespace

TEST_CASE("the grabbed point follows the cursor exactly") {
  const StrokeStart start = start_of(big_ball);
  const SurfacePoint q = SurfaceSearch(big_ball).nearest(big_pole).at;
  for (const Vec3& d : {Vec3(0, 0, 6), Vec3(3, 1, -4), Vec3(0, 5, 0)}) {
    const Vec3 from = q.interpolate(*big_ball.topology, big_ball.points).transpose();
    const auto outcome = made(start, drag(Tool::grab, big_pole, from + d));
    CHECK(!outcome.stopped_by_guard);
    CHECK((q.interpolate(*big_ball.topology, outcome.points).transpose() - (from + d)).norm() < 1e-9);
  }
}

TEST_CASE("an anchored edit is the minimiser for the implied targets pushed by the falloff") {
  const StrokeStart start = start_of(big_ball);
  const Stroke stroke = drag(Tool::grab, big_pole, big_pole + Vec3(1, 2, 4));
  const auto outcome = made(start, stroke);
  const SurfacePoint q = SurfaceSearch(big_ball).nearest(big_pole).at;
  const VertexScalars g = gaussian_falloff(*big_ball.topology, big_ball.points, q, 8,
                                           mean_edge_mm(*big_ball.topology, big_ball.points), false);
  ShapeSolver solver(big_ball.topology);
  const VertexScalars w = start.stiffness_base * *start.stiffness;
  REQUIRE(solver.factorise(w));
  const VertexScalars u = solver.solve(g);
  const Vec3 d = stroke.to - Vec3(q.interpolate(*big_ball.topology, big_ball.points).transpose());
  const double at_q = q.interpolate(*big_ball.topology, u)[0];
  const Points targets = big_ball.points + g / at_q * d.transpose();  // its own shape implies its own points
  const Points minimiser = solver.solve(Points(targets + shape_laplacian(*big_ball.topology, w) * big_ball.points));
  CHECK(largest_difference(outcome.points, minimiser) < 1e-9);
}

TEST_CASE("the result does not depend on the events on the way and going back undoes exactly") {
  const StrokeStart start = start_of(big_ball);
  Deformer deformer;
  for (int event = 1; event <= 30; ++event) {
    REQUIRE(deformer.stroke(start, drag(Tool::grab, big_pole, big_pole + Vec3(0.1 * event, 0, 0.2 * event)),
                            Pass::preview));
  }
  const Stroke last = drag(Tool::grab, big_pole, big_pole + Vec3(3, 0, 6));
  CHECK(largest_difference(deformer.stroke(start, last, Pass::commit)->points, made(start, last).points) == 0);
  const Vec3 q = SurfaceSearch(big_ball).nearest(big_pole).position;
  CHECK(largest_difference(deformer.stroke(start, drag(Tool::grab, big_pole, q), Pass::commit)->points,
                           big_ball.points) < 1e-12);
}

TEST_CASE("a pull ends with the same bytes whether 60 or 1000 events told of its way") {
  const Mesh ball = icosphere(3, 40);
  const auto pulled = [&](int events, const std::function<Vec3(double)>& way) {
    const StrokeStart start = start_of(ball);
    Deformer deformer;
    for (int event = 1; event <= events; ++event)
      REQUIRE(
          deformer.stroke(start, drag(Tool::pull, big_pole, way(static_cast<double>(event) / events)), Pass::preview));
    Stroke last = drag(Tool::pull, big_pole, way(1));
    last.on = deformer.stroke(start, last, Pass::preview)->on;
    return deformer.stroke(start, last, Pass::commit)->points;
  };
  for (const Vec3& to : {Vec3(9, 3, 6), Vec3(-14, 2, -9), Vec3(2, 1, -60)}) {
    const auto straight = [&](double t) { return Vec3(big_pole + t * to); };
    const Points few = pulled(60, straight);
    CHECK(largest_difference(few, ball.points) > 1);
    CHECK(largest_difference(few, pulled(1000, straight)) == 0);
  }
  const auto curved = [](double t) { return Vec3(big_pole + Vec3(9 * t, 6 * std::sin(3 * t), 5 * t * t)); };
  CHECK(largest_difference(pulled(60, curved), pulled(1000, curved)) < 0.01);
}

TEST_CASE("strokes of every tool give the same bits whatever the number of threads") {
  const auto worked = [](int threads) {
    const ThreadLimit limit(threads);
    StrokeStart start = start_of(big_ball);
    Deformer deformer;
    const Vec3 side(40, 0, 0), beside(38, 9, 4);
    for (const Stroke& stroke : {drag(Tool::pull, big_pole, big_pole * 1.2), drag(Tool::grab, side, 1.1 * beside),
                                 drag(Tool::slide, side, beside), drag(Tool::relax, big_pole, beside, 20)}) {
      const auto before = start.points;
      start.points = share(deformer.stroke(start, stroke, Pass::commit).value().points);
      CHECK(largest_difference(*start.points, *before) > 0);
      deformer.end_gesture();
    }
    return *start.points;
  };
  const Points alone = worked(1);
  CHECK(worked(2) == alone);
  CHECK(worked(7) == alone);
}

TEST_CASE("an edit elsewhere never relaxes an earlier one") {
  StrokeStart start = start_of(big_ball);
  start.points = share(made(start, drag(Tool::pull, big_pole, big_pole * 1.2)).points);
  const Points before = *start.points;
  for (int k = 0; k < 10; ++k) {
    start.points = share(made(start, drag(Tool::pull, Vec3(0, 0, -40), Vec3(0, 0, k % 2 == 0 ? -44 : -40), 4)).points);
  }
  const Eigen::Index top = SurfaceSearch(big_ball).nearest(big_pole).at.face;
  const auto corner = big_ball.topology->triangles()(top, 0);
  CHECK((start.points->row(corner) - before.row(corner)).norm() < 0.05);
}

TEST_CASE("the literal scheme of the paper depends on the event rate") {
  StrokeStart start = start_of(big_ball, 1);
  start.scheme = Scheme::paper;
  const Stroke stroke = drag(Tool::grab, big_pole, big_pole + Vec3(0, 0, 8), 5);
  const double one = made(start, stroke).moved_mm;
  start.paper_events = 30;
  const double thirty = made(start, stroke).moved_mm;
  CHECK(one < 7);
  CHECK(thirty < one / 2);
}

TEST_CASE("the raw scheme moves by the Gaussian alone") {
  StrokeStart start = start_of(big_ball);
  start.scheme = Scheme::raw;
  const auto outcome = made(start, drag(Tool::grab, big_pole, big_pole + Vec3(0, 0, 5)));
  const SurfacePoint q = SurfaceSearch(big_ball).nearest(big_pole).at;
  const VertexScalars g = gaussian_falloff(*big_ball.topology, big_ball.points, q, 8,
                                           mean_edge_mm(*big_ball.topology, big_ball.points), false);
  const double reach = big_pole.z() + 5 - q.interpolate(*big_ball.topology, big_ball.points)[2];
  CHECK((outcome.points.col(2) - big_ball.points.col(2) - reach * g).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("a purely lateral pull changes nothing and one with an offset carries the bump along") {
  const StrokeStart start = start_of(big_ball);
  // Along the sphere: the nearest surface point is the cursor itself, up to the facets.
  const Vec3 along = 40 * Vec3(std::sin(0.4), 0, std::cos(0.4));
  const double facet_mm = 0.06;
  CHECK(largest_difference(made(start, drag(Tool::pull, big_pole, along)).points, big_ball.points) < facet_mm);

  Deformer deformer;
  for (double angle = 0; angle <= 0.4; angle += 0.02) {
    const Vec3 cursor = 46 * Vec3(std::sin(angle), 0, std::cos(angle));
    REQUIRE(deformer.stroke(start, drag(Tool::pull, big_pole, cursor), Pass::preview));
  }
  const auto carried = deformer.stroke(start, drag(Tool::pull, big_pole, along * 46 / 40), Pass::commit).value();
  CHECK((carried.on - along).norm() < 0.5);
  Eigen::Index highest = 0;
  carried.points.rowwise().norm().maxCoeff(&highest);
  CHECK((Vec3(carried.points.row(highest).normalized()) - along.normalized()).norm() < 0.05);
}

TEST_CASE("a pull that remembers its surface point needs no cursor path") {
  const StrokeStart start = start_of(big_ball);
  Stroke stroke = drag(Tool::pull, big_pole, 46 * Vec3(std::sin(0.3), 0, std::cos(0.3)));
  const auto followed = made(start, stroke);
  stroke.on = followed.on;
  CHECK(largest_difference(made(start, stroke).points, followed.points) < 1e-9);
}

TEST_CASE("a pull through the middle is held at the medial axis") {
  const StrokeStart start = start_of(big_ball);
  const auto outcome = made(start, drag(Tool::pull, big_pole, Vec3(1, 0, -30)));
  CHECK(outcome.on.z() > 0);
}

TEST_CASE("no gesture turns a triangle however far it goes") {
  const StrokeStart start = start_of(big_ball);
  for (const Tool tool : {Tool::pull, Tool::grab, Tool::slide}) {
    for (const double sigma_mm : {2.0, 8.0, 25.0}) {
      for (const Vec3& to : {Vec3(0, 0, -80), Vec3(90, 20, 60), Vec3(0, -30, 30), Vec3(0, 0, 200)}) {
        const auto outcome = made(start, drag(tool, big_pole, to, sigma_mm));
        CHECK(turned_triangles(*big_ball.topology, big_ball.points, outcome.points).empty());
      }
    }
  }
}

TEST_CASE("the fold guard stops and says so while a fold without it is real") {
  StrokeStart start = start_of(big_ball);
  const Stroke stroke = drag(Tool::grab, big_pole, big_pole + Vec3(25, 0, -10), 3);
  CHECK(made(start, stroke).stopped_by_guard);
  start.scheme = Scheme::raw;
  CHECK(!turned_triangles(*big_ball.topology, big_ball.points, made(start, stroke).points).empty());
}

TEST_CASE("the closed form of the fold guard is the first step at which a triangle reaches its floor") {
  FoldGuard guard(*big_ball.topology, big_ball.points, big_ball.points);
  const SurfacePoint q = SurfaceSearch(big_ball).nearest(big_pole).at;
  const VertexScalars g = gaussian_falloff(*big_ball.topology, big_ball.points, q, 4, 2, false);
  guard.set_response(g);
  // The quality of the worst triangle, its area as seen along its normal at the start.
  const auto worst = [&](const Points& moved) {
    double least = 1;
    for (Eigen::Index f = 0; f < big_ball.topology->triangles().rows(); ++f) {
      const auto c = big_ball.topology->triangles().row(f);
      const auto corner = [&](const Points& p, int k) { return Vec3(p.row(c[k])); };
      const auto normal = [&](const Points& p) {
        return (corner(p, 1) - corner(p, 0)).cross(corner(p, 2) - corner(p, 0)).eval();
      };
      const double edges = (corner(moved, 1) - corner(moved, 0)).squaredNorm() +
                           (corner(moved, 2) - corner(moved, 0)).squaredNorm() +
                           (corner(moved, 2) - corner(moved, 1)).squaredNorm();
      least = std::min(least, 2 * std::sqrt(3.0) * normal(moved).dot(normal(big_ball.points).normalized()) / edges);
    }
    return least;
  };
  for (const Vec3& d : {Vec3(30, 0, 0), Vec3(10, 10, -40), Vec3(-20, 5, 30)}) {
    const double step = guard.largest_step(d);
    REQUIRE(step < 1);
    CHECK(worst(big_ball.points + g * (step * d).transpose()) == doctest::Approx(0.1).epsilon(0.01));
    CHECK(worst(big_ball.points + g * (0.9 * step * d).transpose()) > 0.1);
    CHECK(worst(big_ball.points + g * (1.1 * step * d).transpose()) < 0.1);
  }
}

TEST_CASE("a sliver at the start does not freeze the tool") {
  Mesh mesh = icosphere(3, 40);
  const auto t = mesh.topology->triangles().row(SurfaceSearch(mesh).nearest(big_pole).at.face);
  mesh.points.row(t[0]) = 0.499 * (mesh.points.row(t[1]) + mesh.points.row(t[2])) + 0.002 * mesh.points.row(t[0]);
  const auto outcome = made(start_of(mesh), drag(Tool::grab, big_pole, big_pole + Vec3(0, 0, 4), 15));
  CHECK(outcome.moved_mm > 3);
}

TEST_CASE("sliding moves landmarks along the surface and leaves the surface") {
  const StrokeStart start = start_of(big_ball);
  const auto outcome = made(start, drag(Tool::slide, big_pole, big_pole + Vec3(6, 0, 0)));
  const SurfaceSearch surface(big_ball);
  double farthest = 0;
  for (Eigen::Index i = 0; i < outcome.points.rows(); ++i) {
    farthest = std::max(farthest, surface.nearest(outcome.points.row(i)).distance_mm);
  }
  CHECK(farthest < 1e-9);
  CHECK(outcome.moved_mm > 4);
}

TEST_CASE("boundary vertices of an open mesh slide along their boundary") {
  const Mesh tube = shapes::open_cylinder(12, 32, 20, 40);
  const std::int32_t rim = tube.topology->rims().front().front();
  const Vec3 at = tube.points.row(rim);
  const auto outcome = made(start_of(tube), drag(Tool::slide, at, at + Vec3(2, 4, 5), 6));
  for (const std::int32_t i : tube.topology->rims().front()) {
    CHECK(outcome.points(i, 2) == doctest::Approx(tube.points(i, 2)));
  }
  CHECK((outcome.points.row(rim) - tube.points.row(rim)).norm() > 0.5);
}

TEST_CASE("spacing moves landmarks tangentially near the edit only and a click moves nothing") {
  StrokeStart start = start_of(big_ball);
  start.points = share(made(start, drag(Tool::grab, big_pole, big_pole + Vec3(4, 0, 12), 5)).points);
  start.even_spacing = 1;
  const Vec3 at = SurfaceSearch({big_ball.topology, *start.points}).nearest(Vec3(0, 0, 60)).position;
  const auto click = made(start, drag(Tool::grab, at, at));
  CHECK(largest_difference(click.points, *start.points) < 1e-9);
  const auto outcome = made(start, drag(Tool::grab, at, at + Vec3(0, 0, 2)));
  start.even_spacing = 0;
  const auto without = made(start, drag(Tool::grab, at, at + Vec3(0, 0, 2)));
  CHECK(largest_difference(outcome.points, without.points) > 0.05);
  const auto far = big_ball.topology->triangles()(SurfaceSearch(big_ball).nearest(Vec3(0, 0, -40)).at.face, 0);
  CHECK((outcome.points.row(far) - without.points.row(far)).norm() < 1e-3);
  CHECK(turned_triangles(*big_ball.topology, big_ball.points, outcome.points).empty());
}

TEST_CASE("relax takes a region back towards the reference's shape") {
  StrokeStart start = start_of(big_ball);
  start.points = share(made(start, drag(Tool::grab, big_pole, big_pole + Vec3(0, 0, 10), 4)).points);
  Stroke dab = drag(Tool::relax, Vec3(0, 0, 50), Vec3(0, 0, 50), 15);
  const auto relaxed = made(start, dab);
  CHECK(relaxed.points.col(2).maxCoeff() < start.points->col(2).maxCoeff() - 1);
  CHECK(turned_triangles(*big_ball.topology, big_ball.points, relaxed.points).empty());
  dab.strength = 0;
  CHECK(largest_difference(made(start, dab).points, *start.points) < 1e-12);
}

TEST_CASE("confirmed vertices stay where they are under every scheme and cannot be grabbed") {
  StrokeStart start = start_of(big_ball);
  start.points = share(made(start, drag(Tool::grab, Vec3(40, 0, 0), Vec3(46, 0, 0), 8)).points);
  VertexScalars confirmed = (big_ball.points.col(0).array() > 10).cast<double>();
  start.confirmed = std::make_shared<const VertexScalars>(confirmed);
  for (const Scheme scheme : {Scheme::anchored, Scheme::paper, Scheme::raw}) {
    start.scheme = scheme;
    const auto outcome = made(start, drag(Tool::grab, big_pole, big_pole + Vec3(0, 0, 5), 15));
    for (Eigen::Index i = 0; i < confirmed.size(); ++i) {
      if (confirmed[i] == 1) REQUIRE(outcome.points.row(i) == start.points->row(i));
    }
    CHECK(outcome.moved_mm > 1);
    CHECK(!Deformer().stroke(start, drag(Tool::grab, Vec3(46, 0, 0), Vec3(50, 0, 0)), Pass::commit));
  }
}

TEST_CASE("the falloff stays on the grabbed sheet unless it is asked through space") {
  const Mesh inner = icosphere(3, 30), outer = icosphere(3, 34);
  const Eigen::Index n = inner.points.rows();
  Triangles both(2 * inner.topology->triangles().rows(), 3);
  both << inner.topology->triangles(), (outer.topology->triangles().array() + static_cast<std::int32_t>(n)).matrix();
  Mesh sheets;
  sheets.points.resize(2 * n, 3);
  sheets.points << inner.points, outer.points;
  sheets.topology = Topology::make(2 * n, both).value();
  Stroke stroke = drag(Tool::grab, Vec3(0, 0, 34), Vec3(0, 0, 37));
  CHECK(largest_difference(made(start_of(sheets), stroke).points.topRows(n), inner.points) == 0);
  stroke.through_space = true;
  CHECK(largest_difference(made(start_of(sheets), stroke).points.topRows(n), inner.points) > 0.5);
}

TEST_CASE("a softer stiffness keeps an edit narrower") {
  const auto spread = [](double stiffness) {
    const auto outcome = made(start_of(big_ball, stiffness), drag(Tool::grab, big_pole, big_pole + Vec3(0, 0, 4), 4));
    return outcome.response->sum();
  };
  CHECK(spread(1) < spread(10));
  CHECK(spread(10) < spread(50));
}

TEST_CASE("a turn strains nothing and a growth by a tenth strains a hundredth") {
  const Mesh ball = icosphere(3, 20);
  const Points turned = ball.points * Eigen::AngleAxisd(1.2, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  CHECK(strain_share(*ball.topology, ball.points, turned) < 1e-12);
  CHECK(strain_share(*ball.topology, ball.points, 1.1 * turned) == doctest::Approx(0.01));
}

TEST_CASE("a surface is followed to an end wherever the cursor leaps") {
  const SurfacePoint start = SurfaceSearch(big_ball).nearest(big_pole).at;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const Vec3& to :
       {Vec3(0, 0, 1e308), Vec3(1e300, 1e300, 0), Vec3(infinity, 0, 0), Vec3(0, std::nan(""), 0), Vec3(1e9, 0, 0)}) {
    SurfaceFollower follower(*big_ball.topology, big_ball.points, start, big_pole);
    follower.move_to(to, 1);
    follower.move_to(big_pole + Vec3(0.1, 0, 0), 1);
    CHECK(follower.position().allFinite());
  }
}

TEST_CASE("the search for a step that folds nothing ends for any longest one") {
  const FoldGuard guard(*big_ball.topology, big_ball.points, big_ball.points);
  int tried = 0;
  const auto folded = [&](double) {
    ++tried;
    Points points = big_ball.points;
    points.row(0) *= -1;
    return points;
  };
  for (const double longest : {1.0, 1e308, std::numeric_limits<double>::infinity(), std::nan("")})
    CHECK(guard.accepted_step(longest, folded) == 0);
  CHECK(tried < 200);
}
