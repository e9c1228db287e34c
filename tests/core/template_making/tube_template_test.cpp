#include "core/template_making/tube_template.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/mesh/mesh_quality.h"
#include "core/template_making/tube_body.h"
#include "core/volume/volume_io.h"
#include "tests/real_data.h"

using namespace homolog;

namespace {

using Voxels = std::vector<std::uint8_t>;

/// A map of label 1 on a grid, where `inside(p)` holds.
template <class Inside>
Volume tube_map(const VolumeGeometry& grid, Inside inside) {
  Volume map;
  map.geometry = grid;
  Voxels voxels;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) voxels.push_back(inside(grid.to_mm(Vec3(i, j, k))) ? 1 : 0);
  map.data = std::move(voxels);
  map.range_max = 1;
  return map;
}

/// A grid around the origin.
VolumeGeometry grid_around(const Vec3& spacing_mm, const Mat3& direction, double half_mm = 60) {
  VolumeGeometry grid;
  grid.spacing_mm = spacing_mm;
  grid.direction = direction;
  Vec3 corner;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const int count = static_cast<int>(std::ceil(2 * half_mm / spacing_mm[axis]));
    grid.dims[static_cast<std::size_t>(axis)] = count;
    corner[axis] = -0.5 * spacing_mm[axis] * (count - 1);
  }
  grid.origin_mm = direction * corner;
  return grid;
}

/// A dilated ventricle, apex up, as wide as it is long: its section is an ellipse that narrows upwards and leans, so
/// that its voxels spread least along its own axis. It ends flat at z = -30.
bool in_dilated(const Vec3& p) {
  const double share = (p.z() + 30) / 62;
  if (share < 0 || share >= 1) return false;
  const double narrowed = std::sqrt(1 - share * share);
  return Vec3((p.x() - 0.35 * p.z()) / (40 * narrowed), p.y() / (32 * narrowed), 0).norm() < 1;
}

Mat3 turned(double angle) {
  return Eigen::AngleAxisd(angle, Vec3(1, 0.4, 0.2).normalized()).toRotationMatrix();
}

double label_ml(const Volume& map) {
  double voxels = 0;
  for (const auto voxel : std::get<Voxels>(map.data)) voxels += voxel;
  return voxels * map.geometry.voxel_volume_mm3() / 1000;
}

/// Label 1 of a file alone, as bytes.
Volume first_label(const std::filesystem::path& file) {
  Volume read = read_volume(file).value().volume;
  Voxels voxels(read.geometry.voxels());
  std::visit(
      [&](const auto& values) {
        for (std::size_t v = 0; v < voxels.size(); ++v) voxels[v] = values[v] == 1 ? 1 : 0;
      },
      read.data);
  read.data = std::move(voxels);
  return read;
}

void check_volume(const Volume& map, const TubeTemplate& made) {
  const double wanted = label_ml(map);
  CHECK(made.label_ml == doctest::Approx(wanted));
  CHECK(std::abs(enclosed_volume_ml(made.mesh) / wanted - 1) < 0.03);
  CHECK(made.missing_share < most_missing_share);
  CHECK(missing_from(made, 1).empty());
  CHECK(self_intersections(made.mesh).empty());
}

/// Every second slice of a map.
Volume every_second(const Volume& map) {
  Volume fewer = map;
  const auto& dims = map.geometry.dims;
  const auto slice = static_cast<std::ptrdiff_t>(dims[0]) * dims[1];
  Voxels voxels;
  for (int k = 0; k < dims[2]; k += 2) {
    const auto begin = std::get<Voxels>(map.data).begin() + k * slice;
    voxels.insert(voxels.end(), begin, begin + slice);
  }
  fewer.geometry.dims[2] = (dims[2] + 1) / 2;
  fewer.geometry.spacing_mm[2] *= 2;
  fewer.data = std::move(voxels);
  return fewer;
}

}  // namespace

TEST_CASE("a tube through thick slices runs along their normal and holds what a dilated label holds") {
  for (const Mat3& direction : {Mat3(Mat3::Identity()), turned(0.8), Mat3(turned(0.8) * Vec3(1, -1, 1).asDiagonal())}) {
    const VolumeGeometry grid = grid_around(Vec3(1.5, 1.5, 8), direction);
    const Volume map = tube_map(grid, [&](const Vec3& p) {
      return in_dilated(Vec3(direction.col(0).dot(p), direction.col(1).dot(p), direction.col(2).dot(p)));
    });
    const auto made = make_tube_template(map, {});
    REQUIRE(made);
    CHECK(made->axis.dot(direction.col(2)) > 0.9999);
    check_volume(map, *made);
    // Base and apex lie at the outer faces of the end slices.
    const auto [first, last] = reach_along(tube_body(map, 1).value().region, made->axis);
    const Eigen::VectorXd heights = made->mesh.points * made->axis;
    CHECK(heights.minCoeff() == doctest::Approx(first).epsilon(1e-6));
    CHECK(heights.maxCoeff() == doctest::Approx(last).epsilon(1e-6));
    const Volume fewer = every_second(map);
    const auto of_fewer = make_tube_template(fewer, {});
    REQUIRE(of_fewer);
    check_volume(fewer, *of_fewer);
  }
}

TEST_CASE("a tube of a map with cubic voxels runs from the flat end of its label") {
  for (const double angle : {0.0, 0.5}) {
    const Volume map = tube_map(grid_around(Vec3(1.5, 1.5, 1.5), turned(angle)), &in_dilated);
    const auto made = make_tube_template(map, {});
    REQUIRE(made);
    CHECK(made->axis.z() > 0.99);
    check_volume(map, *made);
  }
}

TEST_CASE("a tube says which share of its label is not in it") {
  const Volume map = tube_map(grid_around(Vec3(1.5, 1.5, 8), Mat3::Identity()), &in_dilated);
  const double whole = label_ml(map);
  TubeTemplateOptions options;
  options.base_and_apex = {Vec3(0, 0, -10), Vec3(0, 0, 40)};
  const auto made = make_tube_template(map, options);
  REQUIRE(made);
  const double lacks = 1 - enclosed_volume_ml(made->mesh) / whole;
  CHECK(lacks > 0.3);
  CHECK(std::abs(made->missing_share - lacks) < 0.06);
  CHECK(missing_from(*made, 3) ==
        std::to_string(std::lround(100 * made->missing_share)) + " % of label 3 is not in the template");
  // The base was clicked below the label's end: the tube begins at the end.
  options.base_and_apex->first = Vec3(0, 0, -45);
  const auto beyond = make_tube_template(map, options);
  REQUIRE(beyond);
  check_volume(map, *beyond);
  options.base_and_apex->first = Vec3(0, 0, 39);
  CHECK_FALSE(make_tube_template(map, options));
}

TEST_CASE("a tube along an axis that is off still holds what the label holds") {
  const Volume map = tube_map(grid_around(Vec3(1.5, 1.5, 8), Mat3::Identity()), &in_dilated);
  TubeTemplateOptions options;
  options.axis = turned(0.35) * Vec3::UnitZ();
  const auto made = make_tube_template(map, options);
  REQUIRE(made);
  CHECK(std::abs(enclosed_volume_ml(made->mesh) / label_ml(map) - 1) < 0.04);
  CHECK(made->missing_share < 0.12);
}

TEST_CASE("tubes of real ventricles hold what the experts drew") {
  const auto folder = real_data();
  if (folder.empty()) return;
  for (const char* name : {"sunnybrook_SC-HF-I-1_ED_label.nii.gz", "sunnybrook_SC-HF-I-1_ES_label.nii.gz"}) {
    const Volume map = first_label(folder / "lv_cine" / name);
    const auto made = make_tube_template(map, {});
    REQUIRE(made);
    CHECK(std::abs(made->axis.dot(map.geometry.direction.col(2))) > 0.9999);
    check_volume(map, *made);
    CHECK(made->from_mask.max_mm < 5);
  }
}
