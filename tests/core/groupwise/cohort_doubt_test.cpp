#include "core/groupwise/cohort_doubt.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/template/template.h"
#include "tests/ball.h"

// Where several fits of a cohort disagree about a subject, and what that makes of its doubt.

namespace homolog {

namespace {

/// As long again by three fifths along z, and turned about it.
Points long_ball(double turn) {
  const Points ball = icosphere(3, 30).points;
  Points points(ball.rows(), 3);
  points.col(0) = std::cos(turn) * ball.col(0) - std::sin(turn) * ball.col(1);
  points.col(1) = std::sin(turn) * ball.col(0) + std::cos(turn) * ball.col(1);
  points.col(2) = 1.6 * ball.col(2);
  return points;
}

FitResult doubted_fit(double doubt_mm, bool mirrored = false) {
  FitResult fit;
  fit.mesh = icosphere(1, 30);
  fit.doubt_mm = VertexScalars::Constant(fit.mesh.points.rows(), doubt_mm);
  fit.mirrored = mirrored;
  return fit;
}

}  // namespace

TEST_CASE("third subjects are the fits in least doubt that are not mirrored") {
  const FitResult much = doubted_fit(4), little = doubted_fit(1), mirrored = doubted_fit(0.5, true),
                  some = doubted_fit(2);
  CHECK(third_subjects({&much, nullptr, &little, &mirrored, &some}, 2) == std::vector<std::size_t>{2, 4});
  CHECK(third_subjects({&much, nullptr, &little, &mirrored, &some}, 9) == std::vector<std::size_t>{2, 4, 0});
}

TEST_CASE("ways through third subjects tell which places a cohort disagrees about") {
  const Mesh ball = icosphere(3, 30);
  const auto the_template = make_template({long_ball(0), ball.topology->triangles()}, "long").value();
  const Boundary boundary = mesh_boundary({the_template->topology, the_template->points});
  FitResult fit;
  fit.mesh = {the_template->topology, the_template->points};
  const Points same = long_ball(0), turned = long_ball(0.4);
  const VertexScalars agreed = spread_by_others_mm2(*the_template, {&same, &same, &same}, boundary, {}, fit).value(),
                      apart =
                          spread_by_others_mm2(*the_template, {&turned, &turned, &turned}, boundary, {}, fit).value(),
                      one_wrong =
                          spread_by_others_mm2(*the_template, {&same, &same, &turned}, boundary, {}, fit).value();
  CHECK(std::sqrt(agreed.mean()) < 0.5);
  CHECK(std::sqrt(one_wrong.mean()) < 6);
  CHECK(std::sqrt(apart.mean()) > 5);
  Eigen::Index pole = 0, equator = 0;
  the_template->points.col(2).maxCoeff(&pole);
  the_template->points.col(0).maxCoeff(&equator);
  CHECK(apart[equator] > 9 * apart[pole]);
  CHECK(spread_by_others_mm2(*the_template, {&same}, boundary, {}, fit).value().size() == 0);  // one tells nothing
  const VertexScalars doubt = VertexScalars::Ones(apart.size()), taken_in = doubt_among_others_mm(doubt, apart);
  CHECK(taken_in[equator] == doctest::Approx(std::sqrt(0.6 + 3 * apart[equator])));
  CHECK(doubt_among_others_mm(doubt, {}) == doubt);
}

}  // namespace homolog
