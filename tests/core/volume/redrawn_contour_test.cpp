#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/volume/redrawn_contour.h"

// A part of a contour drawn anew.

namespace homolog {

namespace {

constexpr double near_mm = 2;

/// Points on a circle of 20 mm about the origin, at z = 5 mm, between two angles in degrees.
std::vector<Vec3> arc(double radius_mm, double from, double to, int pieces) {
  std::vector<Vec3> points;
  for (int k = 0; k <= pieces; ++k) {
    const double angle = (from + (to - from) * k / pieces) * std::numbers::pi / 180;
    points.emplace_back(radius_mm * std::cos(angle), radius_mm * std::sin(angle), 5);
  }
  return points;
}

Contour circle() {
  Contour curve{arc(20, 0, 360, 90)};
  curve.points.pop_back();
  return curve;
}

std::vector<Vec3> line(const Vec3& from, const Vec3& to) {
  std::vector<Vec3> points;
  for (int k = 0; k <= 20; ++k) points.emplace_back(from + k / 20.0 * (to - from));
  return points;
}

/// Signed, in the plane of x and y, mm².
double area_mm2(const Contour& curve) {
  double twice = 0;
  const auto& p = curve.points;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec3 &a = p[k], &b = p[(k + 1) % p.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

double longest_piece_mm(const Contour& curve) {
  double longest = 0;
  const std::size_t n = curve.points.size();
  for (std::size_t k = 0; k + (curve.closed ? 0 : 1) < n; ++k)
    longest = std::max(longest, (curve.points[(k + 1) % n] - curve.points[k]).norm());
  return longest;
}

const double disc_mm2 = 400 * std::numbers::pi;

}  // namespace

TEST_CASE("a stroke out of a circle and back adds its bulge whichever way it is drawn") {
  // A quarter, at 24 mm: it adds a quarter of the ring. It begins and ends 1 mm beside the circle.
  std::vector<Vec3> stroke = arc(24, 10, 80, 40);
  stroke.insert(stroke.begin(), arc(21, 0, 0, 1).front());
  stroke.push_back(arc(21, 90, 90, 1).front());
  const double added = (24.0 * 24 - 400) * std::numbers::pi / 4;
  for (const bool backwards : {false, true}) {
    CAPTURE(backwards);
    if (backwards) std::reverse(stroke.begin(), stroke.end());
    const auto result = redrawn_contour(circle(), stroke, near_mm);
    REQUIRE(result);
    CHECK(result->closed);
    CHECK(area_mm2(*result) > disc_mm2 + 0.7 * added);
    CHECK(area_mm2(*result) < disc_mm2 + 1.0 * added);
    CHECK_FALSE(crosses_itself(*result));
    // Three quarters of the circle are as they were.
    int kept = 0;
    for (const Vec3& p : circle().points) kept += std::ranges::count(result->points, p) > 0 ? 1 : 0;
    CHECK(kept >= 66);
    CHECK(kept <= 68);
    for (const Vec3& p : result->points) CHECK(p.z() == 5);
  }
}

TEST_CASE("of what a stroke cuts in two the larger area stays and a stroke around most of it replaces that") {
  const auto cut = redrawn_contour(circle(), line(Vec3(10, -17, 5), Vec3(10, 17, 5)), near_mm);
  REQUIRE(cut);
  // Without the cap beyond x = 10 mm: R² (π/3 − √3/4).
  CHECK(area_mm2(*cut) == doctest::Approx(disc_mm2 - 400 * (std::numbers::pi / 3 - std::sqrt(3) / 4)).epsilon(0.01));
  const auto most = redrawn_contour(circle(), arc(21.5, 40, 330, 100), near_mm);
  REQUIRE(most);
  CHECK(area_mm2(*most) > 1.08 * disc_mm2);
  CHECK_FALSE(crosses_itself(*most));
}

TEST_CASE("a stroke that overshoots the curve leaves no spur and no gap") {
  // From 1.5 mm within, across the curve, and back across it.
  std::vector<Vec3> stroke = arc(23, 20, 70, 40);
  stroke.insert(stroke.begin(), arc(18.5, 17, 17, 1).front());
  stroke.push_back(arc(18.5, 73, 73, 1).front());
  const auto result = redrawn_contour(circle(), stroke, near_mm);
  REQUIRE(result);
  CHECK_FALSE(crosses_itself(*result));
  CHECK(longest_piece_mm(*result) < 5);
  for (const Vec3& p : result->points) CHECK(p.norm() > std::hypot(19.5, 5));
}

TEST_CASE("an open curve is redrawn between two places and closed by a stroke from end to end") {
  const Contour open{.points = arc(20, 0, 270, 90), .closed = false};
  const auto part = redrawn_contour(open, arc(20, 200, 100, 30), near_mm);
  REQUIRE(part);
  CHECK_FALSE(part->closed);
  CHECK(part->points.front() == open.points.front());
  CHECK(part->points.back() == open.points.back());
  const auto bent = redrawn_contour(open, line(Vec3(0, 20, 5), Vec3(-20, 0, 5)), near_mm);
  REQUIRE(bent);
  double least = 20;
  for (const Vec3& p : bent->points) least = std::min(least, p.head<2>().norm());
  CHECK(least == doctest::Approx(20 / std::sqrt(2)).epsilon(0.01));
  CHECK(longest_piece_mm(*bent) < 2);

  for (const bool backwards : {false, true}) {
    std::vector<Vec3> rest = arc(20.5, 272, 358, 30);
    if (backwards) std::reverse(rest.begin(), rest.end());
    const auto closed = redrawn_contour(open, rest, near_mm);
    REQUIRE(closed);
    CHECK(closed->closed);
    CHECK(area_mm2(*closed) == doctest::Approx(disc_mm2).epsilon(0.02));
    CHECK_FALSE(crosses_itself(*closed));
  }
}

TEST_CASE("a stroke that begins or ends elsewhere redraws nothing") {
  CHECK_FALSE(redrawn_contour(circle(), line(Vec3(20, 0, 5), Vec3(30, 0, 5)), near_mm));
  CHECK_FALSE(redrawn_contour(circle(), line(Vec3(0, 0, 5), Vec3(20, 0, 5)), near_mm));
  CHECK_FALSE(redrawn_contour(circle(), {Vec3(20, 0, 5)}, near_mm));
  CHECK(redrawn_contour(circle(), line(Vec3(21.9, 0, 5), Vec3(0, 21.9, 5)), near_mm));
}

}  // namespace homolog
