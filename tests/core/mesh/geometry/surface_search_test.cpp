#include "core/mesh/geometry/surface_search.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/shapes.h"

using namespace homolog;

namespace {

struct RandomPoints {
  std::mt19937 engine{7};
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  Vec3 point(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
};

Vec3 corner(const Mesh& mesh, Eigen::Index face, int k) {
  return mesh.points.row(mesh.topology->triangles()(face, k));
}

double brute_force_distance(const Mesh& mesh, const Vec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (Eigen::Index f = 0; f < mesh.topology->triangles().rows(); ++f) {
    const Vec3 a = corner(mesh, f, 0), b = corner(mesh, f, 1), c = corner(mesh, f, 2);
    const Vec3 w = nearest_in_triangle(p, a, b, c);
    best = std::min(best, (w[0] * a + w[1] * b + w[2] * c - p).norm());
  }
  return best;
}

Mesh bumpy_torus() {
  Mesh mesh = shapes::torus(24, 12, 20, 7);
  RandomPoints random;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) mesh.points.row(i) += random.point(1).transpose();
  return mesh;
}

}  // namespace

TEST_CASE("the nearest point of a triangle beats every sampled point of it") {
  RandomPoints random;
  for (int trial = 0; trial < 300; ++trial) {
    Vec3 a = random.point(1), b = random.point(1), c = random.point(1);
    if (trial % 10 == 0) c = a + 0.4 * (b - a);  // degenerate: three points on a line
    if (trial % 30 == 0) b = a;
    const Vec3 p = random.point(2);
    const Vec3 w = nearest_in_triangle(p, a, b, c);
    CHECK(w.minCoeff() >= 0);
    CHECK(w.sum() == doctest::Approx(1));
    const double found = (w[0] * a + w[1] * b + w[2] * c - p).norm();
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; i + j <= 20; ++j)
        REQUIRE(found <= ((20 - i - j) * a / 20.0 + i * b / 20.0 + j * c / 20.0 - p).norm() + 1e-12);
  }
}

TEST_CASE("the tree finds the same nearest distance as a search through all faces") {
  const Mesh mesh = bumpy_torus();
  const SurfaceSearch search(mesh);
  RandomPoints random;
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 p = random.point(trial % 2 ? 30 : 300);
    const auto found = search.nearest(p);
    CHECK(found.distance_mm == doctest::Approx(brute_force_distance(mesh, p)).epsilon(1e-12));
    CHECK((found.at.interpolate(*mesh.topology, mesh.points).transpose() - found.position).norm() < 1e-12);
  }
}

TEST_CASE("after a refit the tree answers for the new points") {
  Mesh mesh = icosphere(2, 10);
  SurfaceSearch search(mesh);
  mesh.points = (mesh.points * 0.5).rowwise() + Eigen::RowVector3d(30, -4, 2);
  search.refit(mesh.points);
  RandomPoints random;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 p = random.point(50);
    CHECK(search.nearest(p).distance_mm == doctest::Approx(brute_force_distance(mesh, p)).epsilon(1e-12));
  }
}

TEST_CASE("every ray from inside a closed surface hits it also through its edges and vertices") {
  const Mesh mesh = icosphere(2, 10, {1, 2, 3});
  const SurfaceSearch search(mesh);
  RandomPoints random;
  std::vector<Vec3> aims;
  for (int i = 0; i < 200; ++i) aims.push_back(random.point(1));
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) aims.push_back(Vec3(mesh.points.row(i)) - Vec3(1, 2, 3));
  for (const auto& [a, b] : mesh.topology->edges())
    aims.push_back(Vec3(0.5 * (mesh.points.row(a) + mesh.points.row(b))) - Vec3(1, 2, 3));
  for (const Vec3& aim : aims) {
    const auto hit = search.first_hit({1, 2, 3}, aim);
    REQUIRE(hit);
    CHECK(hit->distance_mm == doctest::Approx(10).epsilon(0.03));
    CHECK((hit->position - Vec3(1, 2, 3)).normalized().dot(aim.normalized()) == doctest::Approx(1));
    CHECK(search.nearest(hit->position).distance_mm < 1e-9);
  }
}

TEST_CASE("a ray takes the first of several hits and none behind it") {
  const SurfaceSearch search(shapes::torus(40, 20, 20, 5));
  const auto from_left = search.first_hit({-100, 0.1, 0.1}, {2, 0, 0});
  REQUIRE(from_left);
  CHECK(from_left->position.x() == doctest::Approx(-25).epsilon(0.01));
  const auto from_middle = search.first_hit({0, 0.1, 0.1}, {2, 0, 0});
  REQUIRE(from_middle);
  CHECK(from_middle->position.x() == doctest::Approx(15).epsilon(0.01));
  CHECK(!search.first_hit({100, 0.1, 0.1}, {2, 0, 0}));
  CHECK(!search.first_hit({0, 0, 0}, {0, 0, 1}));
}

TEST_CASE("looking at every face finds the place that the search finds") {
  const Mesh mesh = bumpy_torus();
  const SurfaceSearch search(mesh);
  RandomPoints random;
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 p = random.point(40);
    const auto found = nearest_on_surface(*mesh.topology, mesh.points, p), expected = search.nearest(p);
    CHECK(found.distance_mm == expected.distance_mm);
    CHECK((found.position - expected.position).norm() < 1e-9);
    CHECK((found.at.interpolate(*mesh.topology, mesh.points).transpose() - found.position).norm() < 1e-9);
  }
}

TEST_CASE("one walk through the tree finds each two faces whose boxes meet once") {
  const Mesh mesh = bumpy_torus();
  const SurfaceSearch search(mesh);
  using Pairs = std::vector<std::array<std::int32_t, 2>>;
  Pairs found, expected;
  search.for_each_near_pair([&](std::int32_t f, std::int32_t g) {
    found.push_back({f, g});
    return true;
  });
  std::vector<Box> boxes;
  for (Eigen::Index f = 0; f < mesh.topology->triangles().rows(); ++f)
    boxes.push_back(Box(corner(mesh, f, 0)).extend(corner(mesh, f, 1)).extend(corner(mesh, f, 2)));
  for (std::size_t f = 0; f < boxes.size(); ++f)
    for (std::size_t g = f + 1; g < boxes.size(); ++g)
      if (boxes[f].intersects(boxes[g]))
        expected.push_back({static_cast<std::int32_t>(f), static_cast<std::int32_t>(g)});
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  CHECK(found == expected);
  int visits = 0;
  search.for_each_near_pair([&](std::int32_t, std::int32_t) { return ++visits < 3; });
  CHECK(visits == 3);
}
