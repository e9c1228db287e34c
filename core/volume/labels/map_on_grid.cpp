#include "core/volume/labels/map_on_grid.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/volume/dicom/dicom_lattice.h"

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
                const std::size_t before = layer.geometry.voxels() * static_cast<std::size_t>(frame);
                result.push_back(inside ? voxels[before + layer.geometry.index(at[0], at[1], at[2])] : T{});
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
  constexpr double nearly_one_step = 0.1;
  const Vec3 first = map.to_voxel(grid.to_mm(Vec3::Zero()));
  VoxelMapping mapping;
  Mat3 steps;  // steps of the axes of the grid in voxels of the map, whole
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(a);
    const Vec3 step = map.to_voxel(grid.to_mm(Vec3::Unit(a))) - first;
    steps.col(a) = step.array().rint();
    for (int b = 0; b < 3; ++b) mapping.steps[at][b] = std::llround(step[b]);
    if ((step - steps.col(a)).cwiseAbs().maxCoeff() > nearly_one_step || steps.col(a).cwiseAbs().sum() != 1) return {};
  }
  if (std::abs(steps.determinant()) != 1) return {};
  // From a voxel of the map that lies near the grid, since steps that differ a little add up.
  const Vec3 last(map.dims[0] - 1, map.dims[1] - 1, map.dims[2] - 1);
  const Vec3 at_grid = grid.to_voxel(map.to_mm(Vec3::Zero())).array().rint();
  const Vec3 whole_first = -steps * at_grid;
  const Vec3 close = near_voxels(grid.spacing_mm);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 voxel((corner & 1) != 0 ? last.x() : 0, (corner & 2) != 0 ? last.y() : 0,
                     (corner & 4) != 0 ? last.z() : 0);
    const Vec3 there = grid.to_voxel(map.to_mm(voxel)), wanted = steps.transpose() * (voxel - whole_first);
    if (((there - wanted).cwiseAbs() - close).maxCoeff() > 0 || !grid.holds(map.to_mm(voxel))) return {};
  }
  for (int b = 0; b < 3; ++b) mapping.first[b] = std::llround(whole_first[b]);
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
