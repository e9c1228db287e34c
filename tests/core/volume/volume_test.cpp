#include "core/volume/volume.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace homolog;

namespace {

VolumeGeometry oblique_geometry(std::array<int, 3> dims) {
  VolumeGeometry geometry;
  geometry.dims = dims;
  geometry.spacing_mm = {0.7, 1.3, 2.5};
  geometry.origin_mm = {-12, 34, 56};
  geometry.direction = (Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())).toRotationMatrix();
  return geometry;
}

template <class T>
Volume volume_of(const VolumeGeometry& geometry, std::vector<T> values, int frames = 1) {
  Volume volume;
  volume.geometry = geometry;
  volume.frames = frames;
  volume.data = std::move(values);
  return volume;
}

}  // namespace

TEST_CASE("voxel and patient coordinates are inverse to each other on left-handed oblique grids") {
  VolumeGeometry geometry = oblique_geometry({5, 6, 7});
  geometry.direction.col(2) *= -1;
  const Vec3 voxel(1.25, 4.5, -2);
  CHECK((geometry.to_voxel(geometry.to_mm(voxel)) - voxel).norm() < 1e-12);
  CHECK(geometry.voxel_volume_mm3() == doctest::Approx(0.7 * 1.3 * 2.5));
}

TEST_CASE("the box around a volume ends half a voxel beyond the outer centres") {
  VolumeGeometry geometry;
  geometry.dims = {4, 3, 2};
  geometry.spacing_mm = {1, 2, 3};
  geometry.origin_mm = {10, 20, 30};
  CHECK((geometry.bounds_mm().min() - Vec3(9.5, 19, 28.5)).norm() < 1e-12);
  CHECK((geometry.bounds_mm().max() - Vec3(13.5, 25, 34.5)).norm() < 1e-12);
}

TEST_CASE("grids are the same within a hundredth of a voxel and not beyond") {
  const VolumeGeometry geometry = oblique_geometry({20, 20, 20});
  VolumeGeometry other = geometry;
  other.origin_mm += 0.005 * geometry.direction.col(0) * geometry.spacing_mm[0];
  CHECK(same_grid(geometry, other));
  other.origin_mm += 0.01 * geometry.direction.col(0) * geometry.spacing_mm[0];
  CHECK(!same_grid(geometry, other));
  other = geometry;
  other.spacing_mm[1] *= 1.01;  // the far corner is a fifth of a voxel away
  CHECK(!same_grid(geometry, other));
  other = geometry;
  other.dims[2] = 21;
  CHECK(!same_grid(geometry, other));
}

TEST_CASE("a geometry's hash survives rounding and notices everything else") {
  const VolumeGeometry geometry = oblique_geometry({20, 21, 22});
  const std::string hash = geometry_hash(geometry);
  CHECK(hash.size() == 16);
  VolumeGeometry other = geometry;
  other.origin_mm[0] += 1e-6;
  CHECK(geometry_hash(other) == hash);
  other.origin_mm[0] = -other.origin_mm[0];
  CHECK(geometry_hash(other) != hash);
  other = geometry;
  other.dims = {21, 20, 22};
  CHECK(geometry_hash(other) != hash);
  other = geometry;
  other.direction.col(0).swap(other.direction.col(1));
  CHECK(geometry_hash(other) != hash);
}

TEST_CASE("interpolation reproduces a linear function and is constant over the outer half voxel") {
  const VolumeGeometry geometry = oblique_geometry({4, 5, 6});
  std::vector<float> values;
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 4; ++i) values.push_back(static_cast<float>(2 * i - 3 * j + 5 * k));
  const Volume volume = volume_of(geometry, std::move(values));
  std::mt19937 random(3);
  for (int n = 0; n < 100; ++n) {
    std::uniform_real_distribution<double> unit(0, 1);
    const Vec3 voxel(3 * unit(random), 4 * unit(random), 5 * unit(random));
    CHECK(volume.sample(geometry.to_mm(voxel), -1e9) ==
          doctest::Approx(2 * voxel[0] - 3 * voxel[1] + 5 * voxel[2]).epsilon(1e-6));
  }
  CHECK(volume.sample(geometry.to_mm({-0.49, 0, 0}), -7) == doctest::Approx(0));
  CHECK(volume.sample(geometry.to_mm({-0.51, 0, 0}), -7) == -7);
  CHECK(volume.sample(geometry.to_mm({3.49, 4, 5.49}), -7) == doctest::Approx(6 - 12 + 25));
  CHECK(volume.sample(geometry.to_mm({3, 4, 5.51}), -7) == -7);
}

TEST_CASE("a single slice is sampled within its thickness and frames are told apart") {
  VolumeGeometry geometry;
  geometry.dims = {2, 2, 1};
  const Volume volume = volume_of<std::int16_t>(geometry, {0, 2, 4, 6, 100, 102, 104, 106}, 2);
  CHECK(volume.sample({0.5, 0.5, 0.4}, -1) == doctest::Approx(3));
  CHECK(volume.sample({0.5, 0.5, 0.4}, -1, 1) == doctest::Approx(103));
  CHECK(volume.at(1, 0, 0, 1) == 102);
}

TEST_CASE("labels are counted frame by frame in every voxel type") {
  VolumeGeometry geometry;
  geometry.dims = {4, 1, 1};
  const auto check = [&](auto type) {
    using T = decltype(type);
    const Volume labels = volume_of<T>(geometry, {T(0), T(3), T(3), T(7), T(7), T(7), T(7), T(0)}, 2);
    CHECK(labels_of(labels) == std::map<int, std::size_t>{{3, 2}, {7, 1}});
    CHECK(labels_of(labels, 1) == std::map<int, std::size_t>{{7, 3}});
  };
  check(std::uint8_t{});
  check(std::int16_t{});
  check(std::uint16_t{});
  check(float{});
  CHECK(labels_of(volume_of<std::int16_t>(geometry, {-5, -5, 0, 1})) == std::map<int, std::size_t>{{-5, 2}, {1, 1}});
  const float nan = std::numeric_limits<float>::quiet_NaN(), huge = 1e30f;
  CHECK(labels_of(volume_of<float>(geometry, {nan, huge, 2, 2})) == std::map<int, std::size_t>{{2, 2}});
}

TEST_CASE("the default window leaves out the tails unless the file asks for its own") {
  VolumeGeometry geometry;
  geometry.dims = {100, 100, 1};
  std::vector<std::int16_t> values(10000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::int16_t>((i * 7919) % 10000);
  Volume volume = volume_of(geometry, values);
  const auto [low, high] = default_window(volume);
  CHECK(std::abs(low - 10) < 2);
  CHECK(std::abs(high - 9824) < 10);
  volume.file_window = {40, 400};
  CHECK(default_window(volume) == std::pair(-160.0, 240.0));
  CHECK(default_window(volume_of(geometry, std::vector<std::uint8_t>(10000, 5))) == std::pair(5.0, 6.0));
}

TEST_CASE("the default window of a large volume is found from a sample and ignores what is not finite") {
  VolumeGeometry geometry;
  geometry.dims = {256, 256, 64};
  std::vector<float> values(geometry.voxels());
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1000);
  for (float& value : values) value = uniform(random);
  values[17] = std::numeric_limits<float>::infinity();
  values[18] = std::numeric_limits<float>::quiet_NaN();
  values[19] = 1e30f;
  const auto [low, high] = default_window(volume_of(geometry, std::move(values)));
  CHECK(std::abs(low - 1) < 0.2);
  CHECK(std::abs(high - 982) < 1);
}

TEST_CASE("the default window of a CT shows soft tissue whatever metal lies in it") {
  VolumeGeometry geometry;
  geometry.dims = {100, 100, 1};
  std::vector<std::int16_t> values(10000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 3 == 0 ? -1000 : static_cast<std::int16_t>(i % 120);
  values[7] = 3071;
  CHECK(default_window(volume_of(geometry, std::move(values))) == std::pair(-160.0, 240.0));
}

TEST_CASE("the default window of an MR is decided by tissue and not by a few bright voxels") {
  VolumeGeometry geometry;
  geometry.dims = {100, 100, 1};
  std::vector<std::int16_t> values(10000);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<std::int16_t>(i % 100 == 0 ? 2000 : i % 2 == 0 ? i % 8 : 100 + i % 200);
  const auto [low, high] = default_window(volume_of(geometry, std::move(values)));
  CHECK(low < 10);
  CHECK(high > 250);
  CHECK(high < 500);
}
