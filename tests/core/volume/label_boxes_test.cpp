#include "core/volume/labels/label_boxes.h"

#include <doctest/doctest.h>

#include <limits>

namespace homolog {

namespace {

/// A turned grid of 8 × 6 × 5 voxels in two frames.
Volume turned_volume() {
  Volume volume;
  volume.geometry.dims = {8, 6, 5};
  volume.geometry.spacing_mm = Vec3(1, 2, 3);
  volume.geometry.origin_mm = Vec3(10, -20, 30);
  volume.geometry.direction << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  volume.frames = 2;
  volume.data = std::vector<float>(2 * volume.geometry.voxels(), 0);
  return volume;
}

float& voxel(Volume& volume, int i, int j, int k, int frame) {
  const auto at = static_cast<std::size_t>(((frame * 5 + k) * 6 + j) * 8 + i);
  return std::get<std::vector<float>>(volume.data)[at];
}

}  // namespace

TEST_CASE("each label of a frame has its box") {
  Volume volume = turned_volume();
  voxel(volume, 1, 2, 3, 1) = 4;
  voxel(volume, 5, 1, 3, 1) = 4.2F;  // rounds to 4
  voxel(volume, 7, 5, 4, 1) = 9;
  voxel(volume, 0, 0, 0, 1) = std::numeric_limits<float>::quiet_NaN();
  voxel(volume, 0, 0, 0, 0) = 2;
  const auto boxes = label_boxes(volume, 1);
  REQUIRE(boxes.size() == 2);
  CHECK(boxes.at(4).first == std::array<int, 3>{1, 1, 3});
  CHECK(boxes.at(4).last == std::array<int, 3>{5, 2, 3});
  CHECK(boxes.at(9).first == boxes.at(9).last);
}

TEST_CASE("a part of a volume lies where it lay, and ends where the volume ends") {
  Volume volume = turned_volume();
  voxel(volume, 6, 3, 2, 1) = 7;
  const Volume part = cropped(volume, {{5, 3, 2}, {6, 4, 2}}, 2, 1);
  CHECK(part.frames == 1);
  CHECK(part.geometry.dims == std::array<int, 3>{5, 5, 5});  // i 3…7, j 1…5, k 0…4
  CHECK(part.at(3, 2, 2) == 7);
  CHECK(part.range_max == 7);
  CHECK((part.geometry.to_mm(Vec3(3, 2, 2)) - volume.geometry.to_mm(Vec3(6, 3, 2))).norm() < 1e-12);
}

TEST_CASE("a grid grows by whole voxels to hold a box") {
  const Volume volume = turned_volume();
  const VolumeGeometry& grid = volume.geometry;
  CHECK(grid_over(grid, grid.bounds_mm()) == grid);
  Box wide = grid.bounds_mm();
  wide.extend(grid.to_mm(Vec3(-2, 0, 0)));
  wide.extend(grid.to_mm(Vec3(0, 0, 6.9)));
  const VolumeGeometry grown = grid_over(grid, wide);
  CHECK(grown.dims == std::array<int, 3>{10, 6, 8});
  CHECK((grown.to_mm(Vec3(2, 0, 0)) - grid.origin_mm).norm() < 1e-12);
  const VoxelBox all = voxels_around(grid.bounds_mm(), grid, 3);
  CHECK(all.first == std::array<int, 3>{0, 0, 0});
  CHECK(all.last == std::array<int, 3>{7, 5, 4});
}

}  // namespace homolog
