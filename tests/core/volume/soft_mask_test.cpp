#include "core/volume/labels/soft_mask.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/adapt/boundary/boundary.h"
#include "core/measure/compare.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/structures/maps/structures_in_map.h"
#include "core/template_making/label_body.h"
#include "core/template_making/mask_template.h"
#include "core/template_making/parts_template.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/write_segmentation.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

using namespace homolog;

namespace {

constexpr double soft_radius_mm = 20;

/// The share of each voxel of 3 mm that lies in one of the balls of that radius, as antialiasing gives it.
Volume soft_balls(const std::vector<Vec3>& centres, float top = 1, std::array<int, 3> dims = {22, 22, 22}) {
  Volume soft;
  soft.geometry.dims = dims;
  soft.geometry.spacing_mm = Vec3::Constant(3);
  soft.geometry.origin_mm = Vec3(-31.3, -30.8, -31.9);
  constexpr int parts = 6;
  std::vector<float> values;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        int in = 0;
        for (int n = 0; n < parts * parts * parts; ++n) {
          const Vec3 within(n % parts, n / parts % parts, n / parts / parts);
          const Vec3 p = soft.geometry.to_mm(Vec3(i, j, k) + (within - Vec3::Constant(2.5)) / parts);
          in += std::any_of(centres.begin(), centres.end(),
                            [&](const Vec3& centre) { return (p - centre).norm() < soft_radius_mm; });
        }
        values.push_back(top * static_cast<float>(in) / (parts * parts * parts));
      }
  soft.data = std::move(values);
  soft.range_max = top;
  return soft;
}

Volume soft_ball() {
  return soft_balls({Vec3::Zero()});
}

Volume as_soft(Volume mask, double level = usual_level) {
  REQUIRE(test::must(make_soft(mask, 0, level)));
  return mask;
}

double off_ball_mm(const Mesh& surface) {
  return mean_surface_distance_mm(surface, icosphere(5, soft_radius_mm));
}

Volume row_of(std::vector<float> values) {
  Volume volume;
  volume.geometry.dims = {static_cast<int>(values.size()), 1, 1};
  volume.data = std::move(values);
  return volume;
}

}  // namespace

TEST_CASE("a soft mask's surface is at most half as far from the true one as that of its voxels") {
  const Volume rounded = soft_ball(), soft = as_soft(soft_ball());
  const auto ratio = [&](const auto& surface_of_mask) {
    const double by_voxels = off_ball_mm(surface_of_mask(rounded)), by_level = off_ball_mm(surface_of_mask(soft));
    MESSAGE("off the ball: " << by_voxels << " mm by voxels, " << by_level << " mm by the level");
    return by_level / by_voxels;
  };
  CHECK(ratio([](const Volume& mask) { return test::must(mask_surface(mask, 1)); }) < 0.5);
  CHECK(ratio([](const Volume& mask) { return test::must(label_boundary(mask, 1, 0, {}, 2500)).surface; }) < 0.5);
  MaskTemplateOptions making;
  making.vertices = 1500;
  making.opening_mm = 0;  // what an opening rounds off is more than a third of a voxel
  CHECK(ratio([&](const Volume& mask) { return test::must(make_mask_template(mask, making)).mesh; }) < 0.5);
  const Mesh ball = icosphere(5, soft_radius_mm);
  const double by_voxels = test::must(compare_with_mask(ball, rounded, 1)).assd_mm;
  CHECK(test::must(compare_with_mask(ball, soft, 1)).assd_mm < 0.5 * by_voxels);
}

TEST_CASE("a higher level gives a smaller surface and 0…255 is 0…1 in other numbers") {
  const auto volume_at = [](double level, float top) {
    return enclosed_volume_ml(test::must(mask_surface(as_soft(soft_balls({Vec3::Zero()}, top), level), 1)));
  };
  CHECK(volume_at(0.3, 1) > 1.02 * volume_at(0.5, 1));
  CHECK(volume_at(0.5, 1) > 1.02 * volume_at(0.7, 1));
  CHECK(volume_at(127.5, 255) == doctest::Approx(volume_at(0.5, 1)).epsilon(1e-4));
}

TEST_CASE("of a soft mask with two parts each is met between its voxels") {
  const Vec3 other(48, 0, 0);
  const Volume soft = as_soft(soft_balls({Vec3::Zero(), other}, 1, {38, 22, 22}));
  const auto one = test::must(label_boundary(soft, 1, 0, {}, 2500, {.all = false, .rank = 0}));
  CHECK(one.parts_left_out == 1);
  Mesh there = one.surface;
  if (there.points.col(0).mean() > 24) there.points.rowwise() -= other.transpose();
  CHECK(off_ball_mm(there) < 0.2);
  MaskTemplateOptions making;
  making.vertices = 2000;
  making.opening_mm = 0;
  const auto both = test::must(make_parts_template(soft, making));
  CHECK(both.mesh.topology->components() == 2);
  CHECK(both.to_mask.mean_mm < 0.15);
}

TEST_CASE("voxels much smaller than the mesh shows are taken in blocks by their mean") {
  const auto off_mm = [](const Volume& mask) {
    const LabelBody body = test::must(label_body(mask, 1, 0, label_extent(mask, 1, 0), 6, 6));
    CHECK(body.grid.spacing_mm == Vec3(Vec3::Constant(6)));
    return off_ball_mm(test::must(boundary_of(body)));
  };
  CHECK(off_mm(as_soft(soft_ball())) < 0.7 * off_mm(soft_ball()));
}

TEST_CASE("soft masks in a folder keep their surfaces until their labels change") {
  const TemporaryFolder folder, again;
  const std::array<int, 3> dims{38, 22, 22};
  REQUIRE(write_volume(soft_balls({Vec3::Zero()}, 1, dims), folder.path / "near.nii.gz"));
  REQUIRE(write_volume(soft_balls({Vec3(48, 0, 0)}, 1, dims), folder.path / "off.nii.gz"));
  VolumeRead map = test::must(read_labels(folder.path));
  CHECK(map.warnings.empty());
  REQUIRE(map.soft.size() == 2);
  CHECK(map.soft[1].shares.geometry.voxels() < map.volume.geometry.voxels());
  TemplateSet set;
  set.structures.resize(2);
  set.structures[0].name = "near";
  set.structures[1].name = "off";
  const SetInMap found = find_in_map(set, map);
  REQUIRE(found.structures[0].is_there());
  REQUIRE(found.structures[0].soft);
  CHECK(found.structures[0].soft->geometry == found.structures[0].mask->geometry);
  const Mesh by_voxels = test::must(mask_surface(*found.structures[0].mask, found.structures[0].segment.value));
  CHECK(off_ball_mm(test::must(mask_surface(*found.structures[0].soft, 1))) < 0.5 * off_ball_mm(by_voxels));

  // One voxel of the second goes, and its surface is that of its voxels.
  auto& voxels = std::get<std::vector<std::uint16_t>>(map.volume.data);
  *std::ranges::find(voxels, std::uint16_t{2}) = 0;
  const SetInMap changed = find_in_map(set, map);
  CHECK(changed.structures[0].soft);
  CHECK_FALSE(changed.structures[1].soft);
  CHECK(changed.structures[1].is_there());
  // What did not change is written as it was read.
  REQUIRE(write_single_masks(map, again.path, folder.path));
  const auto data_of = [](const std::filesystem::path& file) { return test::must(read_volume(file)).volume.data; };
  CHECK(data_of(again.path / "near.nii.gz") == data_of(folder.path / "near.nii.gz"));
  CHECK(std::holds_alternative<std::vector<std::uint8_t>>(data_of(again.path / "off.nii.gz")));
}

TEST_CASE("label maps and images are no soft masks") {
  CHECK(is_soft(row_of({0, 0.25f, 1}), 0));
  CHECK(is_soft(row_of({0, 0.25f, std::numeric_limits<float>::quiet_NaN()}), 0));
  CHECK(!is_soft(row_of({0, 1, 1, 0}), 0));
  CHECK(!is_soft(row_of({0, 1, 2.0118f, 0}), 0));
  CHECK(!is_soft(row_of({-0.5f, 0.5f, 1}), 0));
  Volume grey = row_of({0});
  grey.data = std::vector<std::uint8_t>{128};
  CHECK(!is_soft(grey, 0));
  CHECK(test::must(make_soft(grey, 0, 100)));
  CHECK(labels_of(grey).at(1) == 1);
  Volume hard = row_of({0, 1, 1, 0});
  CHECK(!test::must(make_soft(hard, 0, 0.7)));
  CHECK(!hard.soft);
}

TEST_CASE("a level beyond the values of a mask is refused with the remedy") {
  Volume grey = row_of({0, 17.5f, 200}), image = row_of({0, 900}), below = row_of({-1, 0.5f});
  CHECK(says(make_soft(grey, 0, 0.5), "above 1 for those from 0 to 255"));
  CHECK(says(make_soft(image, 0, 128), "leave out --level"));
  CHECK(says(make_soft(below, 0, 0.5), "holds -1"));
  CHECK(!grey.soft);
}

TEST_CASE("what is no number in a soft mask is background") {
  const Volume soft = as_soft(row_of({0.25f, std::numeric_limits<float>::quiet_NaN(), 0.75f}));
  CHECK(soft.at(1, 0, 0) == 0);
  CHECK(labels_of(soft).at(1) == 1);
}
