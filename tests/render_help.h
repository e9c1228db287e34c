#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "render/offscreen.h"
#include "render/renderer.h"
#include "tests/must.h"

namespace homolog::test {

/// The picture that draw() made of a scene, or its error.
struct Drawn {
  Picture picture;
  Result<void> result;
};

template <class View>
Drawn draw(Renderer& renderer, const Scene& scene, const View& view, int width, int height, int samples = 1) {
  auto framebuffer = must(Framebuffer::make(width, height, samples));
  framebuffer->bind();
  const Result<void> result = renderer.draw(scene, view, {0, 0, width, height, 1});
  return {framebuffer->read(), result};
}

template <class View>
Picture picture_of(const Scene& scene, const View& view, int width, int height, int samples = 1) {
  return draw(*must(Renderer::make()), scene, view, width, height, samples).picture;
}

inline std::array<int, 4> pixel(const Picture& picture, int x, int y) {
  const auto at =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x));
  return {picture.rgba[at], picture.rgba[at + 1], picture.rgba[at + 2], picture.rgba[at + 3]};
}

inline MeshLayer layer_of(const Mesh& mesh) {
  MeshLayer layer;
  layer.topology = mesh.topology;
  layer.points = std::make_shared<const Points>(mesh.points);
  return layer;
}

/// A volume whose voxel (i, j, k) holds value(i, j, k).
template <class T, class Value>
std::shared_ptr<Volume> volume_of(const VolumeGeometry& geometry, const Value& value) {
  auto volume = std::make_shared<Volume>();
  volume->geometry = geometry;
  std::vector<T> data;
  data.reserve(geometry.voxels());
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      for (int i = 0; i < geometry.dims[0]; ++i) data.push_back(static_cast<T>(value(i, j, k)));
    }
  }
  volume->data = std::move(data);
  return volume;
}

/// The three anatomical planes through a point, as the editor shows them.
inline SliceView axial(const Vec3& centre, double mm_per_px) {
  return {centre, Vec3::UnitX(), Vec3::UnitY(), mm_per_px};
}
inline SliceView coronal(const Vec3& centre, double mm_per_px) {
  return {centre, Vec3::UnitX(), -Vec3::UnitZ(), mm_per_px};
}
inline SliceView sagittal(const Vec3& centre, double mm_per_px) {
  return {centre, Vec3::UnitY(), -Vec3::UnitZ(), mm_per_px};
}

}  // namespace homolog::test
