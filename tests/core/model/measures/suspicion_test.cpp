#include "core/model/measures/suspicion.h"

#include <doctest/doctest.h>

#include "core/model/measures/leave_one_out.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// A cohort of 20 balls that vary smoothly in three ways, with landmark noise of 0.02 mm; what `spoil` did to one shape
/// is what the lists should find.
template <class Spoil>
PrincipalComponents cohort(const Mesh& ball, const Spoil& spoil) {
  ShapeMatrix shapes(ball.points.size(), 20);
  std::srand(4);
  for (int k = 0; k < 20; ++k) {
    Points points = ball.points;
    points.col(0) *= 1 + 0.05 * std::sin(k);
    points.col(1) += 0.002 * std::cos(2.0 * k) * points.col(2).cwiseAbs2();
    points.col(2) += 0.05 * std::sin(3.0 * k) * points.col(0);
    points += 0.02 * Points::Random(points.rows(), 3);
    spoil(k, points);
    shapes.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  return principal_components(shapes);
}

}  // namespace

TEST_CASE("fences are those of the quartiles") {
  const Fences fences = fences_of({9, 1, 2, 3, 4, 5, 6, 7, 8});
  CHECK(fences.median == 5);
  CHECK(fences.upper == 7 + 1.5 * 4);
  CHECK(fences.outer == 7 + 3 * 4);
  CHECK(fences_of({4}).outer == 4);
  CHECK(fences_of({}).outer == 0);
}

TEST_CASE("a cohort in order raises no doubt about landmarks or triangles") {
  const Mesh ball = icosphere(3, 40);
  const PrincipalComponents components = cohort(ball, [](int, Points&) {});
  CHECK(suspicious_vertices(components, ball.topology, 3).size() < 3);
  CHECK(suspicious_triangles(components, *ball.topology).size() < 3);
  const auto shapes = shapes_by_distance(components);
  REQUIRE(shapes.size() == 20);
  for (std::size_t k = 1; k < shapes.size(); ++k) CHECK(shapes[k].distance_mm <= shapes[k - 1].distance_mm);
  CHECK(shapes.front().suspicion != Suspicion::far_outside);
  CHECK(shapes.front().distance_mm ==
        doctest::Approx((points_of(components.centred, shapes.front().shape)).rowwise().norm().norm() /
                        std::sqrt(static_cast<double>(ball.points.rows()))));
}

TEST_CASE("a shape far from all others heads the list beyond the outer fence") {
  const Mesh ball = icosphere(2, 40);
  const PrincipalComponents components =
      cohort(ball, [](int k, Points& points) { points.col(2) *= k == 13 ? 1.6 : 1; });
  const auto shapes = shapes_by_distance(components);
  CHECK(shapes.front().shape == 13);
  CHECK(shapes.front().suspicion == Suspicion::far_outside);
}

TEST_CASE("a landmark that slid along the surface is found in its shape") {
  const Mesh ball = icosphere(3, 40);
  const PrincipalComponents components = cohort(ball, [&](int k, Points& points) {
    if (k == 7) points.row(100) += 0.6 * (points.row(ball.topology->one_ring(100)[0]) - points.row(100));
  });
  const auto landmarks = suspicious_vertices(components, ball.topology, 3);
  REQUIRE(!landmarks.empty());
  CHECK(landmarks.front().shape == 7);
  CHECK(landmarks.front().vertex == 100);
  const double moved = 0.6 * (ball.points.row(ball.topology->one_ring(100)[0]) - ball.points.row(100)).norm();
  CHECK(landmarks.front().deviation_mm == doctest::Approx(moved).epsilon(0.1));
  CHECK(landmarks.front().usual_mm < 0.1 * moved);
  const auto triangles = suspicious_triangles(components, *ball.topology);
  REQUIRE(!triangles.empty());
  CHECK(triangles.front().shape == 7);
  const auto faces = ball.topology->faces_of(100);
  CHECK(std::find(faces.begin(), faces.end(), static_cast<std::int32_t>(triangles.front().triangle)) != faces.end());
  CHECK(triangles.front().stretch > 1.4);
  CHECK(triangles.front().usual < 1.1);
}

TEST_CASE("of a swapped region one landmark is listed at its worst place") {
  const Mesh ball = icosphere(3, 40);
  const PrincipalComponents components = cohort(ball, [&](int k, Points& points) {
    if (k != 3) return;
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      const double near = std::exp(-(ball.points.row(v) - ball.points.row(0)).squaredNorm() / 100);
      points.row(v) += near * Eigen::RowVector3d(6, 0, 0);
    }
  });
  const auto landmarks = suspicious_vertices(components, ball.topology, 3);
  CHECK(landmarks.size() < 4);
  REQUIRE(!landmarks.empty());
  CHECK(landmarks.front().shape == 3);
  CHECK((ball.points.row(landmarks.front().vertex) - ball.points.row(0)).norm() < 6);
}

TEST_CASE("a triangle that collapsed to nothing is finite and leads the list") {
  const Mesh ball = icosphere(2, 40);
  const PrincipalComponents components = cohort(ball, [&](int k, Points& points) {
    if (k == 5) points.row(ball.topology->triangles()(9, 0)) = points.row(ball.topology->triangles()(9, 1));
  });
  const auto triangles = suspicious_triangles(components, *ball.topology);
  REQUIRE(!triangles.empty());
  CHECK(triangles.front().shape == 5);
  CHECK(std::isfinite(triangles.front().stretch));
  CHECK(triangles.front().stretch > 100);
}

TEST_CASE("a vertex that varies in every shape and a shape that varies at every vertex are not suspicious there") {
  const Mesh ball = icosphere(3, 40);
  const PrincipalComponents components = cohort(ball, [](int k, Points& points) {
    points.row(50) += std::sin(7.0 * k) * Eigen::RowVector3d(1, 1, -1);  // stands out in each shape
    if (k == 9) points += 0.2 * Points::Random(points.rows(), 3);        // stands out at each vertex
  });
  const auto landmarks = suspicious_vertices(components, ball.topology, 3);
  CHECK(landmarks.size() < 4);
  for (const SuspiciousVertex& one : landmarks) CHECK(one.vertex != 50);
}
