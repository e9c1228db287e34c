#include <doctest/doctest.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/mesh/construction/icosphere.h"
#include "render/label_colours.h"
#include "render/mesh_pass.h"
#include "tests/render_help.h"

namespace homolog {
namespace {

using test::axial, test::coronal, test::sagittal, test::picture_of, test::pixel;

VolumeGeometry oblique_grid() {
  VolumeGeometry grid;
  grid.dims = {20, 16, 12};
  grid.spacing_mm = Vec3(1.5, 2, 3);
  grid.origin_mm = Vec3(-40, 12, 100);
  grid.direction =
      (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(-0.7, Vec3(1, 2, 3).normalized())).toRotationMatrix();
  return grid;
}

VolumeGeometry left_handed_grid() {
  VolumeGeometry grid = oblique_grid();
  grid.direction.col(0) = -grid.direction.col(0);
  return grid;
}

double ramp(const Vec3& voxel) {
  return 5 * voxel.x() + 4 * voxel.y() - 3 * voxel.z() + 40;
}

/// Compares every pixel of a slice with the ramp, worked out in mm from the pixel's place.
void check_slice(const Scene& scene, const SliceView& view) {
  constexpr int kWidth = 61, kHeight = 47;
  const VolumeGeometry& grid = scene.image.volume->geometry;
  const Picture picture = picture_of(scene, view, kWidth, kHeight);
  int inside = 0, outside = 0, wrong = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 p_mm = slice_point_mm(view, {0, 0, kWidth, kHeight, 1}, x + 0.5, y + 0.5);
      const Vec3 voxel = grid.to_voxel(p_mm);
      const Vec3 last(grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1);
      const Vec3 rounded = (voxel + Vec3::Constant(0.5)).array().floor();
      // Right between two voxels or on the outer face either answer is right.
      if ((voxel + Vec3::Constant(0.5) - rounded).cwiseAbs().minCoeff() < 0.01) continue;
      if ((voxel + Vec3::Constant(0.5) - rounded).cwiseAbs().maxCoeff() > 0.99) continue;
      const auto seen = pixel(picture, x, y);
      if ((rounded.array() < 0).any() || (rounded.array() > last.array()).any()) {
        ++outside;
        wrong += seen != std::array{51, 0, 0, 255};
        continue;
      }
      ++inside;
      const Vec3 shown = scene.image.linear ? Vec3(voxel.cwiseMax(Vec3::Zero()).cwiseMin(last)) : rounded;
      const double low = scene.image.window_low, high = scene.image.window_high;
      const double grey = 255 * std::clamp((ramp(shown) - low) / (high - low), 0.0, 1.0);
      // A driver may place linear samples, and filter 8-bit voxels, with eight bits.
      const bool bytes = std::holds_alternative<std::vector<std::uint8_t>>(scene.image.volume->data);
      const double tolerance = !scene.image.linear ? 1 : bytes ? 4 : 2;
      wrong += std::abs(seen[0] - grey) > tolerance || seen[1] != seen[0] || seen[2] != seen[0];
    }
  }
  CHECK(inside > 300);
  CHECK(outside > 100);
  CHECK(wrong == 0);
}

template <class T>
void check_grids_and_planes() {
  for (const VolumeGeometry& grid : {oblique_grid(), left_handed_grid()}) {
    const Vec3 centre = grid.to_mm(Vec3(9.7, 7.2, 5.6));
    const Vec3 along = grid.direction.col(0), across = grid.direction.col(1);
    Scene scene;
    scene.background = {0.2f, 0, 0, 1};
    scene.image.volume = test::volume_of<T>(grid, [](int i, int j, int k) { return ramp(Vec3(i, j, k)); });
    scene.image.window_low = 20;
    scene.image.window_high = 180;
    for (const bool linear : {false, true}) {
      scene.image.linear = linear;
      for (const SliceView& view :
           {axial(centre, 0.9), coronal(centre, 0.9), sagittal(centre, 0.9), SliceView{centre, along, across, 0.8}}) {
        check_slice(scene, view);
      }
    }
  }
}

}  // namespace

namespace {

int uploads = 0;
decltype(epoxy_glBufferData) upload_to_driver = nullptr;

void count_upload(GLenum kind, GLsizeiptr bytes, const void* data, GLenum usage) {
  ++uploads;
  upload_to_driver(kind, bytes, data, usage);
}

}  // namespace

TEST_CASE("a surface is uploaded once with colours of its own or without") {
  const Mesh ball = icosphere(2, 20);
  MeshLayer layer;
  layer.topology = ball.topology;
  layer.points = std::make_shared<const Points>(ball.points);
  layer.surface = true;
  layer.surface_opacity = 1;
  auto pass = MeshPass::make();
  REQUIRE(pass);
  pass->update({layer});
  upload_to_driver = std::exchange(epoxy_glBufferData, count_upload);
  uploads = 0;
  for (int draw = 0; draw < 5; ++draw) pass->update({layer});
  CHECK(uploads == 0);
  layer.colours = std::make_shared<const std::vector<Rgb>>(static_cast<std::size_t>(ball.points.rows()), Rgb{1, 2, 3});
  for (int draw = 0; draw < 5; ++draw) pass->update({layer});
  CHECK(uploads == 1);
  layer.colours = nullptr;
  for (int draw = 0; draw < 5; ++draw) pass->update({layer});
  CHECK(uploads == 2);
  epoxy_glBufferData = upload_to_driver;
}

TEST_CASE("a slice of an int16 volume shows the voxels where they lie in the patient") {
  check_grids_and_planes<std::int16_t>();
}
TEST_CASE("a slice of a uint8 volume shows the voxels where they lie in the patient") {
  check_grids_and_planes<std::uint8_t>();
}
TEST_CASE("a slice of a uint16 volume shows the voxels where they lie in the patient") {
  check_grids_and_planes<std::uint16_t>();
}
TEST_CASE("a slice of a float volume shows the voxels where they lie in the patient") {
  check_grids_and_planes<float>();
}

TEST_CASE("int16 voxels keep their sign and their extremes") {
  VolumeGeometry grid;
  grid.dims = {4, 1, 1};
  const std::array<int, 4> values{-32768, -1000, 0, 32767};
  Scene scene;
  scene.image.volume =
      test::volume_of<std::int16_t>(grid, [&](int i, int, int) { return values[static_cast<std::size_t>(i)]; });
  scene.image.linear = false;
  scene.image.window_low = -2000;
  scene.image.window_high = 0;
  const Picture picture = picture_of(scene, axial(Vec3(1.5, 0, 0), 0.1), 40, 10);
  CHECK(pixel(picture, 5, 5)[0] == 0);
  CHECK(std::abs(pixel(picture, 15, 5)[0] - 128) <= 1);
  CHECK(pixel(picture, 25, 5)[0] == 255);
  CHECK(pixel(picture, 35, 5)[0] == 255);
}

TEST_CASE("a voxel without a number is drawn dark and does not spread") {
  VolumeGeometry grid;
  grid.dims = {5, 5, 1};
  auto volume = test::volume_of<float>(
      grid, [](int i, int j, int) { return i == 2 && j == 2 ? std::numeric_limits<float>::quiet_NaN() : 1.0f; });
  volume->range_max = 1;
  Scene scene;
  scene.image.volume = volume;
  const Picture picture = picture_of(scene, axial(Vec3(2, 2, 0), 0.1), 50, 50);
  CHECK(pixel(picture, 25, 25)[0] < 30);
  CHECK(pixel(picture, 5, 5)[0] == 255);
  CHECK(pixel(picture, 38, 38)[0] == 255);
}

TEST_CASE("another frame of a cine is drawn when it is asked for") {
  VolumeGeometry grid;
  grid.dims = {4, 4, 1};
  auto volume = test::volume_of<std::uint8_t>(grid, [](int, int, int) { return 50; });
  volume->frames = 2;
  auto& data = std::get<std::vector<std::uint8_t>>(volume->data);
  data.resize(32, 200);
  Scene scene;
  scene.image = {volume, 0, 0, 255, true};
  auto renderer = test::must(Renderer::make());
  for (const int frame : {0, 1, 0}) {
    scene.image.frame = frame;
    const Picture picture = test::draw(*renderer, scene, axial(Vec3(1.5, 1.5, 0), 0.2), 16, 16).picture;
    CHECK(pixel(picture, 8, 8)[0] == (frame == 0 ? 50 : 200));
  }
}

TEST_CASE("labels are laid over the image in their colours by nearest voxel") {
  VolumeGeometry grid;
  grid.dims = {12, 12, 3};
  VolumeGeometry fine;
  fine.dims = {24, 24, 3};
  fine.spacing_mm = Vec3(0.5, 0.5, 1);
  Scene scene;
  scene.image.volume = test::volume_of<std::int16_t>(grid, [](int, int, int) { return 100; });
  scene.image.window_high = 200;
  scene.labels.labels = test::volume_of<std::uint16_t>(fine, [](int i, int, int) {
    return i < 8 ? 0 : i < 16 ? 1 : 300;
  });
  scene.labels.opacity = 0.25f;
  const Picture picture = picture_of(scene, axial(Vec3(5.5, 5.5, 1), 0.1), 120, 120);
  const auto expect = [&](int x, int label) {
    const auto seen = pixel(picture, x, 60);
    const Rgb tint = label_colour(label);
    for (std::size_t k = 0; k < 3; ++k) {
      const float blended = label == 0 ? 127.5f : 0.75f * 127.5f + 0.25f * 255 * tint[k];
      CHECK(std::abs(static_cast<float>(seen[k]) - blended) <= 2);
    }
  };
  expect(20, 0);
  expect(60, 1);
  expect(100, 300);
  CHECK(label_colour(300) == label_colour(300 - label_colour_count));
  // The map's own colour is that of its label alone, beyond 255 too.
  auto known = std::make_shared<Volume>(*scene.labels.labels);
  known->range_max = 300;
  scene.labels.labels = known;
  scene.labels.colours =
      std::make_shared<const std::map<int, Rgb>>(std::map<int, Rgb>{{300, {1, 0, 0}}, {45, {0, 0, 1}}});
  const auto own = pixel(picture_of(scene, axial(Vec3(5.5, 5.5, 1), 0.1), 120, 120), 100, 60);
  CHECK(own[0] > own[2] + 50);
  scene.labels.colours = nullptr;
  // A hidden label is not drawn; the one that has its colour stays.
  scene.labels.hidden = std::make_shared<const std::set<int>>(std::set<int>{300});
  const Picture without = picture_of(scene, axial(Vec3(5.5, 5.5, 1), 0.1), 120, 120);
  CHECK(pixel(without, 60, 60) == pixel(picture, 60, 60));
  CHECK(pixel(without, 100, 60) == pixel(picture, 20, 60));
  scene.labels.hidden = std::make_shared<const std::set<int>>(std::set<int>{300 - label_colour_count});
  CHECK(pixel(picture_of(scene, axial(Vec3(5.5, 5.5, 1), 0.1), 120, 120), 100, 60) == pixel(picture, 100, 60));
}

TEST_CASE("a label's edge is more opaque than its inside") {
  VolumeGeometry grid;
  grid.dims = {12, 12, 1};
  Scene scene;
  scene.labels.labels = test::volume_of<std::uint8_t>(grid, [](int i, int, int) { return i < 6 ? 0 : 1; });
  scene.labels.opacity = 0.25f;
  scene.background = {0, 0, 0, 0};
  const Picture picture = picture_of(scene, axial(Vec3(5.5, 5.5, 0), 0.1), 100, 100);
  CHECK(pixel(picture, 49, 50)[3] == 0);
  CHECK(std::abs(pixel(picture, 50, 50)[3] - 128) <= 1);
  CHECK(std::abs(pixel(picture, 51, 50)[3] - 64) <= 1);
}

TEST_CASE("what lies outside the volume has the background's colour and alpha") {
  VolumeGeometry grid;
  grid.dims = {4, 4, 4};
  Scene scene;
  scene.image.volume = test::volume_of<std::uint8_t>(grid, [](int, int, int) { return 1; });
  scene.background = {0.5f, 0.25f, 0, 0};
  Picture picture = picture_of(scene, axial(Vec3(1.5, 1.5, 1.5), 0.1), 80, 80);
  CHECK(pixel(picture, 5, 5) == std::array{0, 0, 0, 0});
  CHECK(pixel(picture, 40, 40) == std::array{255, 255, 255, 255});
  scene.background = {0.5f, 0.25f, 0, 1};
  picture = picture_of(scene, axial(Vec3(1.5, 1.5, 1.5), 0.1), 80, 80);
  CHECK(pixel(picture, 5, 5) == std::array{128, 64, 0, 255});
}

TEST_CASE("drawing stays inside the target rectangle") {
  VolumeGeometry grid;
  grid.dims = {50, 50, 1};
  Scene scene;
  scene.image.volume = test::volume_of<std::uint8_t>(grid, [](int, int, int) { return 1; });
  scene.lines.lines.push_back({Vec3(-50, 25, 0), Vec3(100, 25, 0), {1, 0, 0, 1}, 3});
  scene.meshes.push_back(test::layer_of(icosphere(2, 20, Vec3(25, 25, 0))));
  auto renderer = test::must(Renderer::make());
  auto framebuffer = test::must(Framebuffer::make(100, 80, 1));
  framebuffer->bind();
  glClearColor(0, 0, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  REQUIRE(renderer->draw(scene, axial(Vec3(25, 25, 0), 1), {30, 20, 40, 30, 1}));
  REQUIRE(renderer->draw(scene, Camera3D{}, {75, 55, 20, 20, 1}));
  const Picture picture = framebuffer->read();
  int untouched = 0;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 100; ++x) {
      const int from_below = 79 - y;
      const bool in_slice = x >= 30 && x < 70 && from_below >= 20 && from_below < 50;
      const bool in_space = x >= 75 && x < 95 && from_below >= 55 && from_below < 75;
      untouched += (pixel(picture, x, y) == std::array{0, 0, 255, 255}) == !(in_slice || in_space);
    }
  }
  CHECK(untouched == 8000);
}

TEST_CASE("a volume beyond the texture limit is shown reduced and said so once") {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  VolumeGeometry grid;
  grid.dims = {2 * limit + 10, 2, 2};
  grid.spacing_mm = Vec3(100.0 / grid.dims[0], 1, 1);
  Scene scene;
  scene.image.volume = test::volume_of<std::int16_t>(grid, [&](int i, int, int) { return 1000.0 * i / grid.dims[0]; });
  scene.image.window_high = 1000;
  const SliceView view = axial(grid.to_mm(Vec3(grid.dims[0] / 2.0 - 0.5, 0.5, 0.5)), 1);
  auto renderer = test::must(Renderer::make());
  const test::Drawn first = test::draw(*renderer, scene, view, 120, 10);
  REQUIRE(!first.result);
  CHECK(first.result.error().what.find(std::to_string(grid.dims[0]) + " × 2 × 2 voxels") != std::string::npos);
  CHECK(first.result.error().what.find("3 × 1 × 1") != std::string::npos);
  CHECK(test::draw(*renderer, scene, view, 120, 10).result);
  CHECK(pixel(first.picture, 5, 5)[0] == 0);
  for (const int x : {12, 35, 60, 85, 108}) CHECK(std::abs(pixel(first.picture, x, 5)[0] - 2.55 * (x - 9.5)) < 2);
}

TEST_CASE("a new volume is drawn in place of one that is gone") {
  auto renderer = test::must(Renderer::make());
  VolumeGeometry grid;
  grid.dims = {4, 4, 1};
  for (int value = 10; value < 200; value += 30) {
    Scene scene;
    scene.image.volume = test::volume_of<std::uint8_t>(grid, [&](int, int, int) { return value; });
    scene.image.window_high = 255;
    CHECK(pixel(test::draw(*renderer, scene, axial(Vec3(1.5, 1.5, 0), 0.2), 16, 16).picture, 8, 8)[0] == value);
  }
}

}  // namespace homolog
