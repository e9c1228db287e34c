#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog::test {

/// The value, or a failure of the test with the error's sentence.
template <class T>
T must(Result<T> result) {
  if (!result) FAIL(result.error().sentence());
  return std::move(*result);
}

/// What draw() made of a scene, or its error.
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

/// A sphere of `subdivisions`-times divided icosahedron, counter-clockwise from outside.
inline Mesh sphere(const Vec3& centre, double radius_mm, int subdivisions) {
  const double phi = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> points;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-phi, phi}) {
      points.insert(points.end(), {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)});
    }
  }
  // Faces of the icosahedron: the triples of vertices at edge length 2 from each other.
  std::vector<std::array<int, 3>> faces;
  const auto joined = [&](int i, int j) {
    return std::abs((points[static_cast<std::size_t>(i)] - points[static_cast<std::size_t>(j)]).norm() - 2) < 1e-9;
  };
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (!joined(i, j) || !joined(j, k) || !joined(i, k)) continue;
        const Vec3 &a = points[static_cast<std::size_t>(i)], &b = points[static_cast<std::size_t>(j)],
                   &c = points[static_cast<std::size_t>(k)];
        faces.push_back((b - a).cross(c - a).dot(a) > 0 ? std::array{i, j, k} : std::array{i, k, j});
      }
    }
  }
  for (int round = 0; round < subdivisions; ++round) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int i, int j) {
      const auto [entry, fresh] = middles.try_emplace(std::minmax(i, j), static_cast<int>(points.size()));
      if (fresh) points.push_back(points[static_cast<std::size_t>(i)] + points[static_cast<std::size_t>(j)]);
      if (fresh) points.back().normalize();
      return entry->second;
    };
    for (Vec3& point : points) point.normalize();
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  Mesh mesh;
  mesh.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    mesh.points.row(static_cast<Eigen::Index>(i)) = (centre + radius_mm * points[i].normalized()).transpose();
  }
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) triangles(static_cast<Eigen::Index>(f), k) = faces[f][static_cast<std::size_t>(k)];
  }
  mesh.topology = must(Topology::make(mesh.points.rows(), std::move(triangles)));
  return mesh;
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
