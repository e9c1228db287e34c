#include "core/adapt/fit_doubt.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/adapt/boundary/landmark_pull.h"
#include "core/adapt/judge_fit.h"
#include "core/case/document.h"
#include "core/mesh/mesh_quality.h"
#include "core/template_making/mesh_template.h"
#include "tests/ball.h"
#include "tests/changed_shape.h"
#include "tests/shapes.h"

// What a fit is in doubt about, and how landmarks pull on it, in figures worked out by hand.

namespace homolog {

namespace {

const Mesh& doubted() {
  static const Mesh ball = icosphere(2, 30);
  return ball;
}

/// The doubt of vertex 0 as a share of the root of the surface's area.
double doubt_share(double spread_share, double strain, double roundness,
                   const std::vector<std::int32_t>& missing = {}) {
  const double area_mm2 = surface_area_mm2(doubted());
  const VertexScalars spread = VertexScalars::Constant(doubted().points.rows(), spread_share * spread_share * area_mm2);
  const VertexScalars alike = VertexScalars::Ones(doubted().points.rows());
  return fit_doubt_mm(doubted(), {spread, strain, roundness, missing, alike})[0] / std::sqrt(area_mm2);
}

/// A fit of a plate of 60 × 60 × 6 mm to the same plate `off_mm` above it.
FitJudgement judged_plate(double off_mm) {
  const Mesh plate = shapes::box(Vec3(0, 0, 0), Vec3(60, 60, 6));
  const auto plate_template = make_template({plate.points, plate.topology->triangles()}, "plate").value();
  Mesh above = plate;
  above.points.col(2).array() += off_mm;
  FitResult fit;
  fit.mesh = plate;
  fit.doubt_mm = VertexScalars::Constant(8, 0.1);
  return judge_fit(*plate_template, mesh_boundary(above), {}, fit);
}

}  // namespace

TEST_CASE("doubts add up as squares of known shares") {
  CHECK(doubt_share(0, 0, 0) == doctest::Approx(0.004));
  CHECK(doubt_share(0.003, 0, 0) == doctest::Approx(0.005));
  CHECK(doubt_share(0, 0.01, 0) == doctest::Approx(std::hypot(0.004, 0.006)));
  CHECK(doubt_share(0, 0.1, 0) == doctest::Approx(std::hypot(0.004, 0.06)));
  CHECK(doubt_share(0, 0, 1) == doctest::Approx(std::hypot(0.004, 0.024)));
  CHECK(doubt_share(0, 0, 0.5) == doctest::Approx(std::hypot(0.004, 0.012)));
}

TEST_CASE("doubt lies where vertices can slide along the surface and not at edges") {
  // A bar of 120 × 30 × 30 mm with many vertices: its corners are held in all directions, its faces in one.
  const Mesh bar = spread_over(shapes::box(Vec3(0, 0, 0), Vec3(120, 30, 30)), 1500);
  const VertexScalars shares = shares_of_sliding(bar);
  CHECK(shares.mean() == doctest::Approx(1));
  double level = 0, edges = 0;
  int of_level = 0, of_edges = 0;
  for (Eigen::Index i = 0; i < bar.points.rows(); ++i) {
    const Vec3 p = bar.points.row(i);
    if (p.x() < 40 || p.x() > 80) continue;
    const double y = std::min(p.y(), 30 - p.y()), z = std::min(p.z(), 30 - p.z());
    if (y + z < 4) {
      edges += shares[i];
      ++of_edges;
    } else if (std::max(y, z) > 12) {
      level += shares[i];
      ++of_level;
    }
  }
  REQUIRE(of_level > 10);
  REQUIRE(of_edges > 10);
  CHECK(level / of_level > 1.35 * edges / of_edges);
  const VertexScalars sliding = VertexScalars::LinSpaced(doubted().points.rows(), 0, 2);
  const VertexScalars none = VertexScalars::Zero(doubted().points.rows());
  const auto doubt_mm = [&](const VertexScalars& where) {
    return fit_doubt_mm(doubted(),
                        {.spread_mm2 = none, .strain = 0.1, .roundness = 0, .missing = {}, .sliding = where})[0];
  };
  const double held_mm = doubt_mm(sliding), even_mm = doubt_mm(VertexScalars::Ones(sliding.size()));
  CHECK(held_mm == doctest::Approx(std::sqrt(0.5) * even_mm));
}

TEST_CASE("what is missing is in doubt by its way to what is there and by the strain") {
  const double root_mm = std::sqrt(surface_area_mm2(doubted())), strain = 0.02;
  double nearest_mm = 1e9;
  for (Eigen::Index j = 1; j < doubted().points.rows(); ++j)
    nearest_mm = std::min(nearest_mm, (doubted().points.row(0) - doubted().points.row(j)).norm());
  const double there = doubt_share(0, strain, 0), missing = doubt_share(0, strain, 0, {0});
  CHECK(missing * missing - there * there == doctest::Approx(strain * std::pow(nearest_mm / root_mm + 0.15, 2)));
  std::vector<std::int32_t> all(static_cast<std::size_t>(doubted().points.rows()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::int32_t>(i);
  CHECK(doubt_share(0, 0, 0, all) == doctest::Approx(std::hypot(0.004, 1)));  // it may be anywhere
}

TEST_CASE("a fit is doubtful below nine tenths of overlap") {
  const FitJudgement near = judged_plate(0.5), far = judged_plate(0.75);
  CHECK(near.agreement.dice == doctest::Approx(22.0 / 24).epsilon(0.01));
  CHECK_FALSE(near.doubtful);
  CHECK(far.agreement.dice == doctest::Approx(21.0 / 24).epsilon(0.01));
  CHECK(far.doubtful);
  CHECK(far.warnings.size() == 1);
}

TEST_CASE("a confirmed vertex is in no doubt any more") {
  Document document = ball_document(20, 1);
  Shape& shape = test::changed_shape(document);
  const Eigen::Index n = shape.points->rows();
  CHECK(doubt_left_mm(shape).size() == 0);
  shape.doubt_mm = std::make_shared<const VertexScalars>(VertexScalars::Constant(n, 4));
  VertexScalars confirmed = VertexScalars::Zero(n);
  confirmed[0] = 1;
  confirmed[1] = 0.25;
  shape.confirmed = std::make_shared<const VertexScalars>(confirmed);
  const VertexScalars left = doubt_left_mm(shape);
  CHECK(left[0] == 0);
  CHECK(left[1] == doctest::Approx(3));
  CHECK(left[2] == 4);
}

TEST_CASE("a landmark pulls ten times as much as a vertex and as far as it is trusted") {
  const Mesh ball = icosphere(1, 30);
  const Eigen::RowVector3i t = ball.topology->triangles().row(0);
  const Vec3 weights(0.5, 0.3, 0.2);
  const Vec3 place = ball.points(t, Eigen::all).transpose() * weights;
  const auto known = with_landmarks(*make_template({ball.points, ball.topology->triangles()}, "ball").value(),
                                    {{"unknown", Vec3(0, 0, -30)}, {"tip", place}});
  const Vec3 offset(1, 2, -3), found(0, 5, 0);
  TargetPull pull{ball.points, VertexScalars::Zero(ball.points.rows())};
  pull.targets.row(t[1]) += found.transpose();
  pull.weights[t[1]] = 1;
  const VertexScalars trust = VertexScalars::Constant(1, 0.5);
  pull_landmarks(*known, {{"tip", place + offset}, {"elsewhere", Vec3(0, 0, 0)}}, trust, ball, pull);
  for (int c = 0; c < 3; ++c) {
    const double before = c == 1 ? 1 : 0, share = 10 * 0.5 * weights[c];
    CHECK(pull.weights[t[c]] == doctest::Approx(before + share));
    const Vec3 moved = (pull.targets.row(t[c]) - ball.points.row(t[c])).transpose();
    CHECK((moved - (share * offset + before * found) / (before + share)).norm() < 1e-9);
  }
  CHECK(pull.weights.sum() == doctest::Approx(1 + 5));  // nothing else is pulled
}

TEST_CASE("a landmark below half of trust is said to be unused") {
  const Mesh ball = icosphere(1, 30);
  const auto known = with_landmarks(*make_template({ball.points, ball.topology->triangles()}, "ball").value(),
                                    {{"a", Vec3(0, 0, 30)}, {"b", Vec3(30, 0, 0)}, {"c", Vec3(0, 30, 0)}});
  const std::map<std::string, Vec3> given{{"a", Vec3::Zero()}, {"b", Vec3::Zero()}, {"c", Vec3::Zero()}};
  VertexScalars trust(3), off_mm(3);
  trust << 0.51, 0.49, 1;
  off_mm << 1, 17, 2;
  const auto warnings = warnings_of_landmarks(*known, given, trust, off_mm);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("\"b\" lies 17 mm") != std::string::npos);
}

TEST_CASE("much doubt is six hundredths of the root of an area") {
  CHECK(much_doubt_mm(10'000) == doctest::Approx(6));
  FitResult fit;
  fit.mesh = doubted();
  CHECK(share_of_doubt(fit) == 0);
  const double root_mm = std::sqrt(surface_area_mm2(doubted()));
  fit.doubt_mm = VertexScalars::Constant(doubted().points.rows(), 0.02 * root_mm);
  fit.doubt_mm[0] += 0.01 * root_mm * static_cast<double>(doubted().points.rows());
  CHECK(share_of_doubt(fit) == doctest::Approx(0.03));
}

namespace {

/// A ball stretched along z.
double roundness_of_spindle(double times, double radius_mm) {
  Mesh spindle = icosphere(4, radius_mm);
  spindle.points.col(2) *= times;
  return roundness(spindle);
}

}  // namespace

TEST_CASE("a ball is round, a long spindle is not, and between them it goes by degrees") {
  CHECK(roundness_of_spindle(1, 20) == 1);
  CHECK(roundness_of_spindle(10, 20) == 0);
  double last = 1;
  int between = 0;
  for (double times = 1; times < 10; times += 0.25) {
    const double now = roundness_of_spindle(times, 20);
    CHECK(now <= last);
    if (now > 0 && now < 1) ++between;
    last = now;
  }
  CHECK(between > 2);
}

TEST_CASE("roundness does not depend on the size") {
  const double small = roundness_of_spindle(7, 1);
  CHECK(small > 0);
  CHECK(small < 1);
  CHECK(roundness_of_spindle(7, 500) == doctest::Approx(small).epsilon(1e-9));
}

}  // namespace homolog
