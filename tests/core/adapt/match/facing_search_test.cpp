#include <doctest/doctest.h>

#include <cmath>

#include "core/adapt/match/facing_search.h"
#include "tests/shapes.h"

using namespace homolog;

TEST_CASE("vertices that slid off a ridge are drawn back to it, on a bent organ too") {
  const Mesh own = shapes::shaft_with_ridge(0);
  for (const double turn_rad : {0.0, 1.0}) {
    CAPTURE(turn_rad);
    const Mesh there = shapes::shaft_with_ridge(turn_rad);
    const Points slid = shapes::slid_along(there, Vec3(0, 0, 2.5));
    const TargetPull pull = FacingSearch(there, own.points.rows()).pull(own, {own.topology, slid});
    const double before_mm = shapes::apart_at_ridge_mm(own, slid, there.points),
                 after_mm = shapes::apart_at_ridge_mm(own, pull.targets, there.points);
    CAPTURE(before_mm);
    CAPTURE(after_mm);
    CHECK(after_mm < 0.75 * before_mm);
  }
}

TEST_CASE("where a surface is flat its direction holds vertices weakly, and an edge tells far more") {
  Mesh box = icosphere(5, 15);  // a cube of 30 mm with edges that are a little round
  for (auto p : box.points.rowwise()) p *= 15 / std::pow(p.array().abs().pow(12).sum(), 1.0 / 12);
  const TargetPull pull = FacingSearch(box, box.points.rows()).pull(box, box);
  double flat = 0, edge = 0;
  for (Eigen::Index i = 0; i < box.points.rows(); ++i) {
    const Vec3 p = box.points.row(i).transpose().cwiseAbs();
    if ((p - Vec3(15, 0, 0)).norm() < 3) flat = pull.weights[i];
    if ((p - Vec3(15, 15, 0)).norm() < 3) edge = pull.weights[i];
  }
  CHECK(flat > 0);
  CHECK(edge > 1.8 * flat);
}
