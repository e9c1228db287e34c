#include "core/volume/map_on_grid.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace homolog {

namespace {

/// A layer on a grid of which its voxels are voxels.
Volume layer_on_grid(const Volume& layer, const VolumeGeometry& grid, const VoxelMapping& mapping) {
  Volume placed = layer;
  placed.geometry = grid;
  placed.empty_beyond_slices = false;
  placed.range_min = std::min(layer.range_min, 0.0);
  placed.range_max = std::max(layer.range_max, 0.0);
  const auto& dims = layer.geometry.dims;
  placed.data = std::visit(
      [&]<class T>(const std::vector<T>& voxels) -> VoxelData {
        std::vector<T> result;
        result.reserve(grid.voxels() * static_cast<std::size_t>(layer.frames));
        for (int frame = 0; frame < layer.frames; ++frame)
          for (int k = 0; k < grid.dims[2]; ++k)
            for (int j = 0; j < grid.dims[1]; ++j)
              for (int i = 0; i < grid.dims[0]; ++i) {
                const auto at = mapping.at(i, j, k);
                bool inside = true;
                for (std::size_t a = 0; a < 3; ++a) inside = inside && at[a] >= 0 && at[a] < dims[a];
                const auto voxel = static_cast<std::size_t>((at[2] * dims[1] + at[1]) * dims[0] + at[0]);
                const std::size_t before = layer.geometry.voxels() * static_cast<std::size_t>(frame);
                result.push_back(inside ? voxels[before + voxel] : T{});
              }
        return result;
      },
      layer.data);
  return placed;
}

}  // namespace

std::array<std::int64_t, 3> VoxelMapping::at(std::int64_t i, std::int64_t j, std::int64_t k) const {
  std::array<std::int64_t, 3> voxel{};
  for (std::size_t a = 0; a < 3; ++a) voxel[a] = first[a] + i * steps[0][a] + j * steps[1][a] + k * steps[2][a];
  return voxel;
}

std::optional<VoxelMapping> mapping_of(const VolumeGeometry& grid, const VolumeGeometry& map) {
  constexpr double close = 0.01;
  const Vec3 first = map.to_voxel(grid.to_mm(Vec3::Zero()));
  VoxelMapping mapping;
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(a);
    mapping.first[at] = std::llround(first[a]);
    const Vec3 step = map.to_voxel(grid.to_mm(Vec3::Unit(a))) - first;
    for (int b = 0; b < 3; ++b) mapping.steps[at][static_cast<std::size_t>(b)] = std::llround(step[b]);
    // At the last voxel too, where differences add up.
    const double far = std::max(grid.dims[at] - 1, 1);
    if ((step - step.array().round().matrix()).cwiseAbs().maxCoeff() * far > close) return {};
    if (std::abs(step.cwiseAbs().sum() - 1) > close) return {};
  }
  if ((first - first.array().round().matrix()).cwiseAbs().maxCoeff() > close) return {};
  const Vec3 last(map.dims[0] - 1, map.dims[1] - 1, map.dims[2] - 1);
  for (const Vec3& corner : {Vec3(Vec3::Zero()), last})
    if (!grid.holds(map.to_mm(corner))) return {};
  return mapping;
}

bool put_on_grid(VolumeRead& map, const VolumeGeometry& grid) {
  std::vector<Volume*> layers{&map.volume};
  for (Volume& layer : map.other_layers) layers.push_back(&layer);
  std::vector<VoxelMapping> mappings;  // masks of a folder lie on grids of their own
  for (const Volume* layer : layers) {
    const auto mapping = mapping_of(grid, layer->geometry);
    if (!mapping) return false;
    mappings.push_back(*mapping);
  }
  for (std::size_t k = 0; k < layers.size(); ++k)
    if (!same_grid(layers[k]->geometry, grid)) *layers[k] = layer_on_grid(*layers[k], grid, mappings[k]);
  return true;
}

}  // namespace homolog
