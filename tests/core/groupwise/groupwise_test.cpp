#include <doctest/doctest.h>

#include <cmath>

#include "core/deform/fold_guard.h"
#include "core/deform/tangential.h"
#include "core/groupwise/description.h"
#include "core/groupwise/optimise.h"
#include "core/measure/compare.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "tests/must.h"
#include "tests/shapes.h"
#include "tests/thread_limit.h"

using namespace homolog;

namespace {

/// Six organs with a ridge, two bumps and a hollow, whose true correspondence is known.
std::vector<Mesh> organs() {
  const Mesh ball = icosphere(3, 40);
  std::vector<Mesh> all;
  for (int k = 0; k < 6; ++k) {
    Mesh organ = ball;
    for (Eigen::Index i = 0; i < ball.points.rows(); ++i) {
      const Vec3 u = Vec3(ball.points.row(i)).normalized();
      const double bumps = 9 * std::exp(-12 * (u - Vec3(0.6, 0.8, 0)).squaredNorm()) +
                           7 * std::exp(-12 * (u - Vec3(-0.6, 0, 0.8)).squaredNorm()) -
                           8 * std::exp(-9 * (u - Vec3(0, -0.6, -0.8)).squaredNorm()) + 4 * u.x() * u.y();
      Vec3 p = (40 + bumps) * u;
      p.x() *= 1.3 + 0.1 * std::sin(k);
      p.z() += 0.003 * std::cos(2.0 * k) * p.x() * p.x();
      organ.points.row(i) = p.transpose();
    }
    all.push_back(std::move(organ));
  }
  return all;
}

/// The organs with their vertices slid off their places, each in a way of its own.
TrainingSet slid_off(const std::vector<Mesh>& organs) {
  TrainingSet set;
  set.topology = organs.front().topology;
  set.shapes.resize(organs.front().points.size(), std::ssize(organs));
  for (std::size_t k = 0; k < organs.size(); ++k) {
    const double turn = 0.09 * std::sin(2.5 * static_cast<double>(k));
    Points offset(organs[k].points.rows(), 3);
    for (Eigen::Index i = 0; i < offset.rows(); ++i)
      offset.row(i) = turn * Vec3(0, 0.3, 1).cross(Vec3(organs[k].points.row(i))).transpose();
    const Points slid = slid_along_surface(organs[k], offset);
    set.names.push_back("organ-" + std::to_string(k));
    set.shapes.col(static_cast<Eigen::Index>(k)) = slid.reshaped<Eigen::RowMajor>();
  }
  return set;
}

/// How far equal vertices lie from one anatomical place: each shape's own places, carried to all others, mm.
double correspondence_error_mm(const std::vector<Mesh>& truth, const ShapeMatrix& shapes) {
  double sum = 0;
  int count = 0;
  for (std::size_t a = 0; a < truth.size(); ++a) {
    const SurfaceSearch search({truth[a].topology, points_of(shapes, static_cast<Eigen::Index>(a))});
    for (Eigen::Index i = 0; i < truth[a].points.rows(); i += 7) {
      const SurfacePoint at = search.nearest(truth[a].points.row(i)).at;
      for (std::size_t b = 0; b < truth.size(); ++b) {
        if (a == b) continue;
        const Points other = points_of(shapes, static_cast<Eigen::Index>(b));
        sum += (at.interpolate(*truth[b].topology, other) - truth[b].points.row(i)).norm();
        ++count;
      }
    }
  }
  return sum / count;
}

}  // namespace

TEST_CASE("what is expected of a shape makes the set shorter to describe") {
  std::srand(5);
  const Descriptions set = Descriptions::Random(60, 7);
  for (const double precision : {0.05, 0.3, 2.0}) {
    const Descriptions expected = expected_from_others(set, precision);
    for (Eigen::Index k = 0; k < set.cols(); ++k) {
      Descriptions moved = set;
      moved.col(k) = expected.col(k);
      CHECK(description_bits(moved, precision) < description_bits(set, precision));
    }
  }
  const Eigen::VectorXd mean_of_others = (set.rowwise().sum() - set.col(3)) / 6;
  CHECK((expected_from_others(set, 1e6).col(3) - mean_of_others).norm() < 1e-6);
  Descriptions copies = set;
  copies.col(4) = copies.col(2);
  CHECK((expected_from_others(copies, 1e-4).col(4) - copies.col(2)).norm() < 1e-4);
  CHECK(description_bits(Descriptions::Ones(9, 4), 0.1) == doctest::Approx(0));
}

TEST_CASE("sliding brings vertices nearer to the places that they mean and leaves the surfaces") {
  const std::vector<Mesh> truth = organs();
  const TrainingSet set = slid_off(truth);
  const OptimisedSet optimised = test::must(optimise_set(set, {}));
  const double before_mm = correspondence_error_mm(truth, set.shapes),
               after_mm = correspondence_error_mm(truth, optimised.shapes);
  MESSAGE("mean error " << before_mm << " mm before, " << after_mm << " mm after; the surfaces moved by "
                        << optimised.surface_moved_mm << " mm");
  CHECK(after_mm < 0.9 * before_mm);
  CHECK(optimised.after.bits < optimised.before.bits);
  CHECK(optimised.turned_triangles == 0);
  for (Eigen::Index k = 0; k < set.shapes.cols(); ++k) {
    const Mesh was{set.topology, points_of(set.shapes, k)}, is{set.topology, points_of(optimised.shapes, k)};
    const double edge_mm = mean_edge_mm(*set.topology, was.points);
    CHECK(surface_distance(was, is).max_mm < 0.1 * edge_mm);
    CHECK(surface_distance(is, was).max_mm < 0.1 * edge_mm);
    CHECK(mesh_quality(is).min_angle_deg > 0.5 * mesh_quality(was).min_angle_deg);
  }
}

TEST_CASE("held vertices and those at named landmarks stay exactly") {
  const TrainingSet set = slid_off(organs());
  GroupwiseOptions options;
  options.rounds = 3;
  for (Eigen::Index k = 0; k < set.shapes.cols(); ++k) {
    MeshFile file{points_of(set.shapes, k), set.topology->triangles()};
    file.landmarks = {{"top", file.points.colwise().maxCoeff().transpose()}};
    if (k == 2) file.arrays["confirmed"] = (file.points.col(0).array() > 20).cast<double>();
    options.held.push_back(held_vertices(file, *set.topology, true));
    CHECK(options.held.back().sum() >= 3);
    CHECK(held_vertices(file, *set.topology, false).size() == (k == 2 ? file.points.rows() : 0));
  }
  const GroupwiseResult result = test::must(slide_together(set.topology, set.shapes, options));
  double moved = 0;
  for (Eigen::Index k = 0; k < set.shapes.cols(); ++k) {
    const Points was = points_of(set.shapes, k), is = points_of(result.shapes, k);
    for (Eigen::Index i = 0; i < was.rows(); ++i) {
      if (options.held[static_cast<std::size_t>(k)][i] > 0) CHECK(was.row(i) == is.row(i));
      moved = std::max(moved, (was.row(i) - is.row(i)).norm());
    }
  }
  CHECK(moved > 0.1);
}

TEST_CASE("an optimised set has the same bits whatever the number of threads") {
  const TrainingSet set = slid_off(organs());
  GroupwiseOptions options;
  options.rounds = 3;
  ShapeMatrix one;
  {
    const ThreadLimit limit(1);
    one = test::must(slide_together(set.topology, set.shapes, options)).shapes;
  }
  const ThreadLimit limit(5);
  CHECK(one == test::must(slide_together(set.topology, set.shapes, options)).shapes);
}

TEST_CASE("an optimisation that cannot be done or is cancelled says so") {
  TrainingSet set = slid_off(organs());
  Progress progress;
  progress.cancel();
  GroupwiseOptions options;
  options.progress = &progress;
  CHECK(optimise_set(set, options).error().what.find("cancelled") != std::string::npos);
  const auto alone = slide_together(set.topology, set.shapes.leftCols(1));
  CHECK(alone.error().what.find("two") != std::string::npos);
  set.topology = nullptr;
  CHECK(optimise_set(set, {}).error().sentence().find("organ-0: has points only") == 0);
}
