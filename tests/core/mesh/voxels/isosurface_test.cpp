#include "core/mesh/voxels/isosurface.h"

#include <doctest/doctest.h>

#include <random>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/cube_cases.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/volume/volume_io.h"
#include "tests/real_data.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

Volume mask_of(std::array<int, 3> dims, const std::function<bool(const Vec3&)>& inside) {
  Volume mask;
  mask.geometry.dims = dims;
  std::vector<std::uint8_t> voxels;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) voxels.push_back(inside(Vec3(i, j, k)) ? 3 : 0);
  mask.data = std::move(voxels);
  return mask;
}

}  // namespace

TEST_CASE("every case of the cube and its complement crosses the same edges") {
  for (unsigned cube = 0; cube < 256; ++cube) {
    unsigned used[2] = {0, 0};
    for (int side = 0; side < 2; ++side)
      for (const auto& triangle : cube_cases().triangles[side ? 255 - cube : cube])
        for (const auto edge : triangle) used[side] |= 1u << edge;
    CHECK(used[0] == used[1]);
  }
}

TEST_CASE("masks of noise have closed manifold surfaces that enclose their voxels") {
  std::mt19937 engine(11);
  for (const double density : {0.02, 0.2, 0.5, 0.8, 0.98}) {
    std::bernoulli_distribution coin(density);
    const Volume mask = mask_of({13, 9, 11}, [&](const Vec3&) { return coin(engine); });
    const auto surface = mask_surface(mask, 3);
    REQUIRE_MESSAGE(surface, surface.error().sentence());
    CHECK(surface->topology->closed());
    CHECK(self_intersections(*surface).empty());
    const auto inside = voxelise(*surface, mask.geometry);
    const auto& voxels = std::get<std::vector<std::uint8_t>>(mask.data);
    for (std::size_t i = 0; i < voxels.size(); ++i) REQUIRE((inside[i] != 0) == (voxels[i] == 3));
  }
}

TEST_CASE("the surface of a ball is one sphere of nearly its volume and of a ring one torus") {
  const auto ball =
      mask_surface(mask_of({40, 40, 40}, [](const Vec3& p) { return (p - Vec3(19, 20, 18.5)).norm() < 15; }), 3)
          .value();
  CHECK(ball.topology->genus() == 0);
  CHECK(ball.topology->components() == 1);
  CHECK(enclosed_volume_ml(ball) == doctest::Approx(4.0 / 3 * 3.14159265 * 3.375).epsilon(0.01));
  CHECK(self_intersections(ball).empty());
  const auto ring = mask_surface(mask_of({40, 40, 20},
                                         [](const Vec3& p) {
                                           const Vec3 q = p - Vec3(20, 20, 10);
                                           return std::hypot(q.head<2>().norm() - 12, q.z()) < 5;
                                         }),
                                 3)
                        .value();
  CHECK(ring.topology->genus() == 1);
  CHECK(ring.topology->components() == 1);
}

TEST_CASE("a single voxel and voxels on the border of the grid are closed around") {
  const auto voxel = mask_surface(mask_of({1, 1, 1}, [](const Vec3&) { return true; }), 3).value();
  CHECK(voxel.points.rows() == 6);
  CHECK(voxel.topology->closed());
  CHECK(enclosed_volume_ml(voxel) == doctest::Approx(1.0 / 6000));
  const auto full = mask_surface(mask_of({4, 5, 6}, [](const Vec3&) { return true; }), 3).value();
  CHECK(full.topology->genus() == 0);
  CHECK(bounds_of(full.points).min() == Vec3::Constant(-0.5));
  CHECK(bounds_of(full.points).max() == Vec3(3.5, 4.5, 5.5));
}

TEST_CASE("the surface looks outward and lies in place on grids of any handedness") {
  Volume mask = mask_of({20, 20, 20}, [](const Vec3& p) { return (p - Vec3(8, 9, 10)).norm() < 6; });
  mask.geometry.spacing_mm = {2, 1, 0.5};
  mask.geometry.origin_mm = {-40, 7, 3};
  for (const double sign : {1.0, -1.0}) {
    mask.geometry.direction = Eigen::AngleAxisd(1.1, Vec3(1, -1, 2).normalized()).toRotationMatrix();
    mask.geometry.direction.col(1) *= sign;
    const auto surface = mask_surface(mask, 3).value();
    CHECK(enclosed_volume_ml(surface) > 0);
    CHECK((bounds_of(surface.points).center() - mask.geometry.to_mm(Vec3(8, 9, 10))).norm() < 0.5);
  }
}

TEST_CASE("frames and labels are told apart and a missing label is named") {
  Volume mask = mask_of({6, 6, 6}, [](const Vec3& p) { return (p - Vec3(2, 2, 2)).norm() < 1.5; });
  auto voxels = std::get<std::vector<std::uint8_t>>(mask.data);
  const std::size_t frame = voxels.size();
  voxels.resize(2 * frame, 0);
  voxels[frame + 43] = 7;
  mask.data = voxels;
  mask.frames = 2;
  CHECK(mask_surface(mask, 3, 0));
  CHECK(mask_surface(mask, 7, 1).value().points.rows() == 6);
  CHECK(mask_surface(mask, 7, 0).error().what.find("label 7 does not occur") != std::string::npos);
}

TEST_CASE("surfaces of real masks are closed and manifold and enclose exactly their voxels") {
  const auto data = real_data();
  if (data.empty()) return;
  for (const char* name :
       {"kidney_masks/case_00002_right_healthy_thin.nii.gz", "kidney_masks/case_00000_right_tumour_thin.nii.gz"}) {
    const auto read = read_volume(data / name);
    REQUIRE_MESSAGE(read, read.error().sentence());
    const Volume& mask = read->volume;
    const int label = labels_of(mask).begin()->first;
    const auto surface = mask_surface(mask, label);
    REQUIRE_MESSAGE(surface, surface.error().sentence());
    CHECK(surface->topology->closed());
    const auto inside = voxelise(*surface, mask.geometry);
    std::size_t wrong = 0;
    std::visit(
        [&](const auto& voxels) {
          for (std::size_t i = 0; i < inside.size(); ++i) wrong += (inside[i] != 0) != has_label(voxels[i], label);
        },
        mask.data);
    CHECK(wrong == 0);
  }
}
