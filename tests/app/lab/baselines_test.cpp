#include "app/lab/baselines.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/must.h"
#include "tests/shapes.h"

using namespace homolog;

TEST_CASE("point drift follows a smooth deformation that closest points do not") {
  const Mesh ball = icosphere(3, 40);
  Points start = ball.points, target = ball.points;
  for (Eigen::Index i = 0; i < target.rows(); ++i) {
    const Vec3 p = ball.points.row(i);
    start.row(i) = Vec3(1.5 * p.x(), p.y(), 0.6 * p.z()).transpose();
    target.row(i) = Vec3(1.5 * p.x() + 6, p.y() + 0.004 * p.x() * p.x(), 0.6 * p.z() + 0.15 * p.x()).transpose();
  }
  PointDriftOptions options;
  options.points = 400;
  const Points drifted = test::must(point_drift(start, target, options));
  CHECK(mean_distance(drifted, target) < 0.5 * mean_distance(start, target));
  CHECK(test::must(point_drift(start, target, options)) == drifted);
  // Lengths have no unit of their own.
  CHECK(largest_difference(test::must(point_drift(10 * start, 10 * target, options)), 10 * drifted) < 1e-6);
}

TEST_CASE("point drift of what it cannot carry is refused") {
  const Points three = Points::Random(3, 3), one_place = Points::Ones(9, 3), some = Points::Random(9, 3);
  CHECK(point_drift(three, some).error().what.find("four") != std::string::npos);
  CHECK(point_drift(some, one_place).error().what.find("extent") != std::string::npos);
  Progress progress;
  progress.cancel();
  CHECK(point_drift(some, some, {.progress = &progress}).error().what.find("cancelled") != std::string::npos);
}
