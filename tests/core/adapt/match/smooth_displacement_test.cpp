#include <doctest/doctest.h>

#include <cmath>

#include "core/adapt/match/smooth_displacement.h"
#include "core/mesh/mesh_quality.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

constexpr DisplacementScales scales{
    .bend_mm = 6, .bend_reach_mm = 20, .fine_mm = 2, .fine_reach_mm = 6, .stretch = 0.1};

SmoothDisplacement::Coefficients some_coefficients(Eigen::Index nodes) {
  SmoothDisplacement::Coefficients some(nodes, 3);
  for (Eigen::Index i = 0; i < some.size(); ++i) some.data()[i] = std::sin(1 + 2.4 * static_cast<double>(i));
  return some;
}

}  // namespace

TEST_CASE("a displacement is the same by its basis and by its bumps") {
  const Mesh ball = icosphere(2, 20);
  const SmoothDisplacement displacement(ball.points.topRows(12), Eigen::RowVector3d(1, 2, 3), scales);
  const auto by = some_coefficients(displacement.nodes());
  const Points by_basis = displacement.basis(ball.points).value * by;
  CHECK(by_basis.norm() > 10);
  CHECK((by_basis - displacement.at(ball.points, by)).norm() < 1e-6);
}

TEST_CASE("normals turn with a displacement as those of the displaced surface") {
  const Mesh ball = icosphere(5, 20);
  const SmoothDisplacement displacement(icosphere(1, 20).points, Eigen::RowVector3d(1, 2, 3), scales);
  const auto by = SmoothDisplacement::Coefficients(0.3 * some_coefficients(displacement.nodes()));
  const Mesh there{ball.topology, ball.points + displacement.at(ball.points, by)};
  const Points before = vertex_normals(ball), expected = vertex_normals(there),
               turned = displacement.turned_normals(displacement.basis(ball.points), before, by);
  CHECK((expected - before).rowwise().norm().mean() > 0.05);
  CHECK((expected - turned).rowwise().norm().maxCoeff() < 0.02);
}
