#include "core/mesh/colours.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <numeric>
#include <random>

#include "core/mesh/mesh_quality.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

Topology shuffled(const Topology& topology) {
  std::vector<std::int32_t> name(static_cast<std::size_t>(topology.vertices()));
  std::iota(name.begin(), name.end(), 0);
  std::shuffle(name.begin(), name.end(), std::mt19937(1));
  Triangles triangles = topology.triangles();
  for (std::int32_t& v : triangles.reshaped()) v = name[static_cast<std::size_t>(v)];
  return *Topology::make(topology.vertices(), triangles).value();
}

}  // namespace

TEST_CASE("breadth-first rank numbers every vertex once and never before all nearer ones") {
  const Mesh mesh = shapes::torus(12, 9);
  const auto rank = breadth_first_rank(*mesh.topology, 17);
  auto sorted = rank;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i) REQUIRE(sorted[i] == static_cast<std::int32_t>(i));
  CHECK(rank[17] == 0);
  for (const std::int32_t near : mesh.topology->one_ring(17)) {
    CHECK(rank[static_cast<std::size_t>(near)] <= std::ssize(mesh.topology->one_ring(17)));
    CHECK(rank[static_cast<std::size_t>(near)] > 0);
  }
}

TEST_CASE("the second component is ranked behind the whole first one") {
  const Triangles one = shapes::tetrahedron().topology->triangles();
  Triangles two(8, 3);
  two << one, one.array() + 4;
  const auto rank = breadth_first_rank(*Topology::make(8, two).value(), 6);
  CHECK(*std::max_element(rank.begin() + 4, rank.end()) == 3);
  CHECK(*std::min_element(rank.begin(), rank.begin() + 4) == 4);
}

TEST_CASE("grids keep their index as hue and shuffled meshes take a breadth-first rank") {
  CHECK(indices_are_local(*shapes::open_cylinder(30, 24).topology));
  CHECK(indices_are_local(*shapes::open_cylinder(5, 200).topology));
  CHECK(indices_are_local(*shapes::torus(60, 20).topology));
  const Topology mixed = shuffled(*icosphere(4).topology);
  CHECK(!indices_are_local(mixed));
  const auto grid_hues = vertex_hues(*shapes::open_cylinder(30, 24).topology);
  CHECK(grid_hues[100] == doctest::Approx(100.0 / 720));
  const auto hues = vertex_hues(mixed);
  double largest = 0;
  for (const auto& [a, b] : mixed.edges())
    largest = std::max(
        largest, std::abs(static_cast<double>(hues[static_cast<std::size_t>(a)]) - hues[static_cast<std::size_t>(b)]));
  CHECK(largest < 0.1);
}

TEST_CASE("HSV meets the primary colours and grey and white") {
  const auto near = [](const Rgb& a, const Rgb& b) {
    for (std::size_t c = 0; c < 3; ++c) CHECK(a[c] == doctest::Approx(b[c]).epsilon(1e-5));
  };
  near(hsv_to_rgb(0, 1, 1), {1, 0, 0});
  near(hsv_to_rgb(1.0f / 6, 1, 1), {1, 1, 0});
  near(hsv_to_rgb(1.0f / 3, 1, 1), {0, 1, 0});
  near(hsv_to_rgb(2.0f / 3, 1, 1), {0, 0, 1});
  near(hsv_to_rgb(1, 1, 1), {1, 0, 0});
  near(hsv_to_rgb(0.3f, 0, 0.5f), {0.5f, 0.5f, 0.5f});
  near(hsv_to_rgb(0, 0.4f, 1), {1, 0.6f, 0.6f});
}

TEST_CASE("curvature of a sphere is 1 over its radius squared and its integral is the Euler number") {
  const Mesh sphere = icosphere(4, 5);
  const VertexScalars curvature = gaussian_curvature(sphere);
  CHECK(curvature.mean() == doctest::Approx(0.04).epsilon(0.01));
  CHECK(curvature.minCoeff() > 0.03);
  for (const auto& [mesh, euler] : {std::pair(shapes::torus(30, 15), 0), std::pair(shapes::box(), 2)}) {
    VertexScalars area = VertexScalars::Zero(mesh.points.rows());
    const Triangles& t = mesh.topology->triangles();
    for (Eigen::Index f = 0; f < t.rows(); ++f) {
      const Vec3 a = mesh.points.row(t(f, 0)), b = mesh.points.row(t(f, 1)), c = mesh.points.row(t(f, 2));
      for (int k = 0; k < 3; ++k) area[t(f, k)] += (b - a).cross(c - a).norm() / 6;
    }
    CHECK(gaussian_curvature(mesh).dot(area) == doctest::Approx(2 * std::numbers::pi * euler).scale(1));
  }
  const VertexScalars tube = gaussian_curvature(shapes::open_cylinder(6, 20));
  CHECK(tube.cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("glyphs start at the sharpest vertex and keep their distance and leave no room for more") {
  Mesh mesh = icosphere(4, 10);
  mesh.points.row(77) *= 1.5;
  constexpr double spacing_mm = 3;
  const auto glyphs = glyph_vertices(mesh, spacing_mm);
  REQUIRE(!glyphs.empty());
  CHECK(glyphs[0] == 77);
  for (std::size_t a = 0; a < glyphs.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      CHECK((mesh.points.row(glyphs[a]) - mesh.points.row(glyphs[b])).norm() > spacing_mm);
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    CHECK(std::any_of(glyphs.begin(), glyphs.end(),
                      [&](std::int32_t g) { return (mesh.points.row(i) - mesh.points.row(g)).norm() <= spacing_mm; }));
  CHECK(glyph_vertices(mesh, 0).size() == 2562);
}
