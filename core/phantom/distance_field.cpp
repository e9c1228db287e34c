#include "core/phantom/distance_field.h"

#include <algorithm>
#include <cmath>

#include "core/base/processes/parallel.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/voxels/voxelise.h"

namespace homolog::phantom {
namespace {

/// The part of a grid of which a mesh comes near.
struct Window {
  VolumeGeometry grid;
  std::array<int, 3> first{};
};

Window window_around(const Box& box, const VolumeGeometry& grid) {
  Window window{grid};
  const Vec3 low = grid.to_voxel(box.min()), high = grid.to_voxel(box.max());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const int from = std::clamp(static_cast<int>(std::floor(low[at])), 0, grid.dims[axis] - 1);
    const int to = std::clamp(static_cast<int>(std::ceil(high[at])), 0, grid.dims[axis] - 1);
    window.first[axis] = from;
    window.grid.dims[axis] = to - from + 1;
  }
  window.grid.origin_mm = grid.to_mm({1.0 * window.first[0], 1.0 * window.first[1], 1.0 * window.first[2]});
  return window;
}

/// The distances of one mesh in its window.
std::vector<float> distances(const Mesh& mesh, const VolumeGeometry& grid, double reach_mm) {
  const auto inside = voxelise(mesh, grid);
  const auto far = static_cast<float>(reach_mm);
  std::vector<float> field;
  field.reserve(inside.size());
  for (const std::uint8_t in : inside) field.push_back(in != 0 ? -far : far);
  const SurfaceSearch search(mesh);
  std::vector<bool> known(inside.size());
  std::int32_t near_face = 0;
  for (Eigen::Index face = 0; face < mesh.topology->triangles().rows(); ++face) {
    Box box;
    for (int corner = 0; corner < 3; ++corner)
      box.extend(Vec3(mesh.points.row(mesh.topology->triangles()(face, corner))));
    box.min().array() -= reach_mm;
    box.max().array() += reach_mm;
    const Window around = window_around(box, grid);
    near_face = static_cast<std::int32_t>(face);
    for (int k = around.first[2]; k < around.first[2] + around.grid.dims[2]; ++k)
      for (int j = around.first[1]; j < around.first[1] + around.grid.dims[1]; ++j)
        for (int i = around.first[0]; i < around.first[0] + around.grid.dims[0]; ++i) {
          const std::size_t n = grid.index(i, j, k);
          if (known[n]) continue;
          known[n] = true;
          const auto d = search.nearest(grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k}), near_face).distance_mm;
          if (d < reach_mm) field[n] = static_cast<float>(inside[n] != 0 ? -d : d);
        }
  }
  return field;
}

}  // namespace

std::vector<float> distance_field(const std::vector<Mesh>& meshes, const VolumeGeometry& grid, double reach_mm) {
  std::vector<Window> windows;
  std::vector<std::vector<float>> parts(meshes.size());
  for (const Mesh& mesh : meshes) {
    Box box = bounds_of(mesh.points);
    box.min().array() -= reach_mm;
    box.max().array() += reach_mm;
    windows.push_back(window_around(box, grid));
  }
  for_each_in_parallel(meshes.size(),
                       [&](std::size_t m) { parts[m] = distances(meshes[m], windows[m].grid, reach_mm); });
  std::vector<float> field(grid.voxels(), static_cast<float>(reach_mm));
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const auto& [part, first] = windows[m];
    auto value = parts[m].begin();
    for (int k = 0; k < part.dims[2]; ++k)
      for (int j = 0; j < part.dims[1]; ++j) {
        const std::size_t row = grid.index(first[0], j + first[1], k + first[2]);
        for (std::size_t i = 0; i < static_cast<std::size_t>(part.dims[0]); ++i, ++value) {
          float& here = field[row + i];
          here = std::min(here, *value);
        }
      }
  }
  return field;
}

}  // namespace homolog::phantom
