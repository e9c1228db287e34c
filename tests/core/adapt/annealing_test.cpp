#include "core/adapt/annealing.h"

#include <doctest/doctest.h>

#include "tests/shapes.h"

namespace homolog {

namespace {

constexpr Annealing some_steps{.steps = 8, .softest_edges = 1};

/// A ball that keeps to itself.
Adapting ball_at_rest() {
  const Mesh ball = icosphere(3, 20);
  return {ball, ball.points, {}, ball.points, VertexScalars::Ones(ball.points.rows()), {}};
}

/// Pulls the vertices for which `pulled(i)` holds to `targets`, and next to nothing at the others.
template <class Pulled>
ForceSource to(const Points& targets, const Pulled& pulled) {
  return [targets, pulled](const Mesh& mesh, double) {
    Force force{VertexScalars::Ones(mesh.points.rows()), mesh.points};
    for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
      if (!pulled(i)) continue;
      force.weights[i] = 1 / least_weight;
      force.pulls.row(i) = force.weights[i] * targets.row(i);
    }
    return force;
  };
}

void anneal_with(Adapting& shape, const ForceSource& force) {
  ShapeSolver solver(shape.mesh.topology);
  REQUIRE(anneal(shape, solver, some_steps, force));
}

}  // namespace

TEST_CASE("a mesh goes to any force and its reference goes along") {
  Adapting shape = ball_at_rest();
  const Similarity away{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vec3(1, 2, 2) / 3)), 1.1, Vec3(5, -3, 8)};
  const Points targets = away.apply(shape.rest);
  anneal_with(shape, to(targets, [](Eigen::Index) { return true; }));
  CHECK((shape.mesh.points - targets).rowwise().norm().maxCoeff() < 0.2);
  CHECK((shape.placed - shape.mesh.points).rowwise().norm().maxCoeff() < 0.2);
  CHECK(shape.placement.rotation.angularDistance(away.rotation) < 0.02);
}

TEST_CASE("where no force is known the shape decides") {
  Adapting shape = ball_at_rest();
  const Points before = shape.rest, targets = before.rowwise() + Eigen::RowVector3d(10, 0, 0);
  const auto upper = [&](Eigen::Index i) { return before(i, 2) > 0; };
  anneal_with(shape, to(targets, upper));
  CHECK((shape.mesh.points - targets).rowwise().norm().maxCoeff() < 3);
  CHECK((shape.mesh.points - targets).rowwise().norm().mean() < 1);
}

TEST_CASE("pins are met and those that contradict each other bend the mesh between them and do not tear it") {
  const auto pinned = [](const std::vector<Vec3>& offs) {
    Adapting shape = ball_at_rest();
    // Pins close together on one face, and one far off.
    for (std::size_t k = 0; k < offs.size(); ++k) {
      const SurfacePoint on{0, {0.5 + 1e-5 * static_cast<double>(k), 0.3, 0.2 - 1e-5 * static_cast<double>(k)}};
      shape.pins.push_back({on, on.interpolate(*shape.mesh.topology, shape.rest).transpose() + offs[k]});
    }
    anneal_with(shape, to(shape.rest, [](Eigen::Index) { return true; }));
    return shape;
  };
  const auto off_mm = [](const Adapting& shape, std::size_t k) {
    const Pin& pin = shape.pins[k];
    return (pin.place.transpose() - pin.on.interpolate(*shape.mesh.topology, shape.mesh.points)).norm();
  };
  const Adapting one = pinned({Vec3(0, 0, 2)});
  CHECK(off_mm(one, 0) < 1e-9);
  const Adapting two = pinned({Vec3(0, 0, 2), Vec3(0, 2, 0)});
  const double farthest_mm = (two.mesh.points - two.rest).rowwise().norm().maxCoeff();
  CAPTURE(farthest_mm);
  CHECK(farthest_mm < 5);  // 10,000 mm where both had to be met
  for (const std::size_t k : {0U, 1U}) CHECK(off_mm(two, k) == doctest::Approx(std::sqrt(2.0)).epsilon(0.1));
}

TEST_CASE("the softest stiffness comes last and decides how small a bump the mesh follows") {
  const auto height_mm = [](const Annealing& annealing) {
    Adapting shape = ball_at_rest();
    Points targets = shape.rest;
    targets.row(0) *= 1.15;  // 3 mm at one vertex
    ShapeSolver solver(shape.mesh.topology);
    REQUIRE(anneal(shape, solver, annealing, to(targets, [](Eigen::Index) { return true; })));
    return shape.mesh.points.row(0).norm() - 20;
  };
  const double soft = height_mm({.steps = 8, .softest_edges = 1}), stiff = height_mm({.steps = 8, .softest_edges = 4});
  CHECK(soft > 0.8);
  CHECK(stiff < 0.5 * soft);
  CHECK(height_mm({.steps = 8, .softest_edges = 0.5}) > 1.2 * soft);
}

TEST_CASE("the first step is as stiff as a share of the diagonal") {
  const auto height_mm = [](double stiffest_share) {
    Adapting shape = ball_at_rest();
    Points targets = shape.rest;
    targets.row(0) *= 1.15;
    ShapeSolver solver(shape.mesh.topology);
    double first_mm = 0;
    REQUIRE(anneal(shape, solver, {.steps = 4, .softest_edges = 1, .stiffest_share = stiffest_share},
                   to(targets, [](Eigen::Index) { return true; }), [&](double share) -> Result<void> {
                     if (share == 0) first_mm = shape.mesh.points.row(0).norm() - 20;
                     return {};
                   }));
    return first_mm;
  };
  CHECK(height_mm(0.3) < 0.1);
  CHECK(height_mm(0.05) > 5 * height_mm(0.3));
}

TEST_CASE("held vertices stay to the last bit and their surroundings fade towards them") {
  Adapting shape = ball_at_rest();
  const Points before = shape.rest, targets = before.rowwise() + Eigen::RowVector3d(4, 0, 0);
  for (Eigen::Index i = 0; i < before.rows(); ++i)
    if (before(i, 0) < -15) shape.held.push_back(static_cast<std::int32_t>(i));
  anneal_with(shape, to(targets, [](Eigen::Index) { return true; }));
  const VertexScalars moved = (shape.mesh.points - before).rowwise().norm();
  for (const std::int32_t i : shape.held) CHECK(moved[i] == 0);
  for (Eigen::Index i = 0; i < before.rows(); ++i) {
    if (before(i, 0) > 10) CHECK(moved[i] > 3);
    for (const std::int32_t j : shape.mesh.topology->one_ring(i)) CHECK(std::abs(moved[i] - moved[j]) < 3);
  }
}

TEST_CASE("the annealing goes from share 0 to share 1 and ends where a step says so") {
  Adapting shape = ball_at_rest();
  ShapeSolver solver(shape.mesh.topology);
  std::vector<double> shares;
  const ForceSource stay = to(shape.rest, [](Eigen::Index) { return true; });
  REQUIRE(anneal(shape, solver, some_steps, stay, [&](double share) -> Result<void> {
    shares.push_back(share);
    return {};
  }));
  REQUIRE(shares.size() == 8);
  CHECK(shares.front() == 0);
  CHECK(shares.back() == 1);
  const auto refused = anneal(shape, solver, some_steps, stay, [](double share) -> Result<void> {
    return share > 0.5 ? Result<void>(fail("", "enough")) : Result<void>();
  });
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what == "enough");
}

TEST_CASE("an annealing of one step is its last one") {
  Adapting shape = ball_at_rest();
  Points targets = shape.mesh.points;
  targets.row(0) *= 1.1;
  ShapeSolver solver(shape.mesh.topology);
  std::vector<double> shares;
  REQUIRE(anneal(shape, solver, {.steps = 1, .softest_edges = 1}, to(targets, [](Eigen::Index i) { return i == 0; }),
                 [&](double share) -> Result<void> {
                   shares.push_back(share);
                   return {};
                 }));
  CHECK(shares == std::vector<double>{1});
  CHECK(shape.mesh.points.allFinite());
  CHECK((shape.mesh.points.row(0) - targets.row(0)).norm() < 1.5);  // of 2 mm: one step follows so far
}

}  // namespace homolog
