#include "core/mesh/voxels/voxelise.h"

#include <doctest/doctest.h>

#include <numeric>
#include <random>

#include "core/mesh/mesh_quality.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

VolumeGeometry cube_grid(int size, double spacing_mm, const Vec3& origin_mm) {
  VolumeGeometry grid;
  grid.dims = {size, size, size};
  grid.spacing_mm.setConstant(spacing_mm);
  grid.origin_mm = origin_mm;
  return grid;
}

double claimed_ml(const Mesh& mesh, const VolumeGeometry& grid) {
  const auto inside = voxelise(mesh, grid);
  return static_cast<double>(std::accumulate(inside.begin(), inside.end(), std::size_t{0})) * grid.voxel_volume_mm3() /
         1000;
}

}  // namespace

TEST_CASE("the voxels of a sphere add up to its volume the better the finer they are") {
  const Mesh sphere = icosphere(4, 20);
  const double exact = enclosed_volume_ml(sphere);
  CHECK(claimed_ml(sphere, cube_grid(32, 1.5, Vec3::Constant(-23.3))) == doctest::Approx(exact).epsilon(0.01));
  CHECK(claimed_ml(sphere, cube_grid(96, 0.5, Vec3::Constant(-23.3))) == doctest::Approx(exact).epsilon(0.001));
}

TEST_CASE("a voxel is set exactly when its centre is in a convex shape") {
  const Mesh shape = icosphere(1, 10, {0.3, -0.2, 0.1});
  VolumeGeometry grid = cube_grid(24, 1, Vec3(-12.1, -11.9, -12.05));
  grid.direction = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  grid.direction.col(2) *= -1;  // left-handed
  grid.spacing_mm = {0.9, 1.3, 1.1};
  grid.origin_mm = -grid.direction * grid.spacing_mm.cwiseProduct(Vec3(11.5, 11.5, 11.5));
  const auto inside = voxelise(shape, grid);
  const Triangles& t = shape.topology->triangles();
  std::size_t voxel = 0;
  for (int k = 0; k < 24; ++k) {
    for (int j = 0; j < 24; ++j) {
      for (int i = 0; i < 24; ++i) {
        const Vec3 p = grid.to_mm(Vec3(i, j, k));
        bool expected = true;
        for (Eigen::Index f = 0; f < t.rows() && expected; ++f) {
          const Vec3 a = shape.points.row(t(f, 0)), b = shape.points.row(t(f, 1)), c = shape.points.row(t(f, 2));
          expected = (b - a).cross(c - a).dot(p - a) < 0;
        }
        REQUIRE((inside[voxel++] != 0) == expected);
      }
    }
  }
}

TEST_CASE("boxes side by side on voxel centres share them out without gap or overlap") {
  // All faces run through voxel centres: every tie there can be.
  const VolumeGeometry grid = cube_grid(9, 1, Vec3::Zero());
  std::vector<int> claims(grid.voxels(), 0);
  for (int part = 0; part < 8; ++part) {
    const Vec3 low(part & 1 ? 4 : 0, part & 2 ? 4 : 0, part & 4 ? 4 : 0);
    const auto inside = voxelise(shapes::box(low, low + Vec3::Constant(4)), grid);
    CHECK(std::accumulate(inside.begin(), inside.end(), 0) == 64);
    for (std::size_t i = 0; i < claims.size(); ++i) claims[i] += inside[i];
  }
  CHECK(*std::max_element(claims.begin(), claims.end()) == 1);
  CHECK(std::accumulate(claims.begin(), claims.end(), 0) == 512);
  const auto whole = voxelise(shapes::box(Vec3::Zero(), Vec3::Constant(8)), grid);
  CHECK(std::equal(claims.begin(), claims.end(), whole.begin(), whole.end()));
}

TEST_CASE("shapes cut by a rough common surface share out all voxels") {
  // Two halves of a box whose common side has heights on and off voxel centres, in one numbering each.
  constexpr int n = 8;
  std::mt19937 engine(5);
  std::uniform_int_distribution<int> height(6, 14);
  std::vector<double> heights((n + 1) * (n + 1));
  for (double& h : heights) h = height(engine) / 2.0;
  const auto half = [&](bool upper) {
    std::vector<Vec3> points;
    std::vector<std::array<std::int32_t, 3>> faces;
    const auto at = [&](int x, int y, int level) { return level * (n + 1) * (n + 1) + y * (n + 1) + x; };
    for (int level = 0; level < 2; ++level)
      for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x)
          points.emplace_back(
              x, y, (level == 1) == upper ? (upper ? 10 : 0) : heights[static_cast<std::size_t>(y * (n + 1) + x)]);
    const auto quad = [&](int a, int b, int c, int d) {
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    };
    for (int u = 0; u < n; ++u) {
      for (int v = 0; v < n; ++v) {
        quad(at(u, v, 1), at(u + 1, v, 1), at(u + 1, v + 1, 1), at(u, v + 1, 1));
        faces.push_back({at(u, v, 0), at(u + 1, v + 1, 0), at(u + 1, v, 0)});
        faces.push_back({at(u, v, 0), at(u, v + 1, 0), at(u + 1, v + 1, 0)});
      }
      quad(at(u, 0, 0), at(u + 1, 0, 0), at(u + 1, 0, 1), at(u, 0, 1));
      quad(at(u + 1, n, 0), at(u, n, 0), at(u, n, 1), at(u + 1, n, 1));
      quad(at(0, u + 1, 0), at(0, u, 0), at(0, u, 1), at(0, u + 1, 1));
      quad(at(n, u, 0), at(n, u + 1, 0), at(n, u + 1, 1), at(n, u, 1));
    }
    return shapes::make_mesh(points, faces);
  };
  for (const int turn : {0, 1, 2}) {  // the common side seen along each axis of the rays
    VolumeGeometry grid = cube_grid(12, 1, Vec3::Constant(-1));
    grid.direction << (turn == 0), (turn == 2), (turn == 1), (turn == 1), (turn == 0), (turn == 2), (turn == 2),
        (turn == 1), (turn == 0);
    const auto low = voxelise(half(false), grid), high = voxelise(half(true), grid);
    const auto whole = voxelise(shapes::box(Vec3::Zero(), Vec3(8, 8, 10)), grid);
    for (std::size_t i = 0; i < whole.size(); ++i) REQUIRE(low[i] + high[i] == whole[i]);
    CHECK(std::accumulate(whole.begin(), whole.end(), 0) == 640);
  }
}

TEST_CASE("a mesh that leaves the grid or misses it claims only what is there") {
  const Mesh sphere = icosphere(3, 10);
  const auto all = voxelise(sphere, cube_grid(30, 1, Vec3::Constant(-14.5)));
  VolumeGeometry half = cube_grid(30, 1, Vec3::Constant(-14.5));
  half.dims = {15, 30, 30};
  const auto left = voxelise(sphere, half);
  for (std::size_t row = 0; row < 900; ++row)
    for (std::size_t i = 0; i < 15; ++i) REQUIRE(left[row * 15 + i] == all[row * 30 + i]);
  half.origin_mm.x() = 0.5;
  const auto right = voxelise(sphere, half);
  for (std::size_t row = 0; row < 900; ++row)
    for (std::size_t i = 0; i < 15; ++i) REQUIRE(right[row * 15 + i] == all[row * 30 + i + 15]);
  const auto none = voxelise(sphere, cube_grid(8, 1, Vec3::Constant(1e9)));
  CHECK(std::count(none.begin(), none.end(), 0) == 512);
}

TEST_CASE("an open tube claims the voxels up to its flat caps") {
  const Mesh tube = shapes::open_cylinder(4, 100, 8, 20);
  CHECK(claimed_ml(tube, cube_grid(60, 0.5, Vec3(-14.9, -14.9, -4.9))) ==
        doctest::Approx(enclosed_volume_ml(tube)).epsilon(0.003));
}
