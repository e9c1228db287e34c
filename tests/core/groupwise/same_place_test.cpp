#include "core/groupwise/same_place.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/mesh/construction/icosphere.h"

// Whether several fits with one template are off at the same place, so that the template is unsuited.

namespace homolog {

namespace {

constexpr double radius_mm = 30, dent_mm = 6;

/// A ball with a dent of 6 mm around a direction: what a template without it cannot follow.
Boundary dented(const Vec3& towards) {
  Mesh ball = icosphere(4, radius_mm);
  for (Eigen::Index i = 0; i < ball.points.rows(); ++i) {
    const double away_mm = radius_mm * std::acos(std::clamp(ball.points.row(i).dot(towards) / radius_mm, -1.0, 1.0));
    if (away_mm < 10) ball.points.row(i) *= 1 - dent_mm / radius_mm;
  }
  return mesh_boundary(ball);
}

VertexScalars off_share(const Mesh& fitted, const Vec3& towards) {
  return off_target_mm(fitted, dented(towards)) / bounds_of(fitted.points).diagonal().norm();
}

}  // namespace

TEST_CASE("a fit is off by the depth of a dent at the dent and nowhere else") {
  const Mesh ball = icosphere(3, radius_mm);
  const VertexScalars off_mm = off_target_mm(ball, dented(Vec3::UnitX()));
  for (Eigen::Index i = 0; i < off_mm.size(); ++i) {
    const double away_mm = radius_mm * std::acos(std::min(ball.points(i, 0) / radius_mm, 1.0));
    if (away_mm < 5) CHECK(std::abs(off_mm[i] - dent_mm) < 1);
    if (away_mm > 18) CHECK(off_mm[i] < 0.6);
  }
}

TEST_CASE("fits that are off at one place name it and fits that are off anywhere do not") {
  const Mesh ball = icosphere(3, radius_mm);
  const auto x = off_share(ball, Vec3::UnitX()), y = off_share(ball, Vec3::UnitY()), z = off_share(ball, Vec3::UnitZ());
  CHECK_FALSE(off_at_same_place(*ball.topology, {x, y, z}));
  CHECK_FALSE(off_at_same_place(*ball.topology, {x, x}));  // of two nobody can tell
  const auto same = off_at_same_place(*ball.topology, {x, y, x, z, x});
  REQUIRE(same);
  CHECK(same->fits == 3);
  for (const std::int32_t i : same->vertices) CHECK(ball.points(i, 0) > 0.8 * radius_mm);
  CHECK(same->vertices.size() > 5);
  CHECK_FALSE(off_at_same_place(*ball.topology, {x, x, x, y, y, y, z, z, z, z * 0}));  // fewer than a third each
}

}  // namespace homolog
