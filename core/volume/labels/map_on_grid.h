#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/volume/volume_io.h"

namespace homolog {

/// The place of a grid's voxel in a label map: first + steps · (i, j, k), all whole numbers.
struct VoxelMapping {
  std::array<std::int64_t, 3> first{};
  std::array<std::array<std::int64_t, 3>, 3> steps{};  ///< the step of each grid axis along the map's axes

  /// The voxel of the map; it may lie beyond it.
  std::array<std::int64_t, 3> at(std::int64_t i, std::int64_t j, std::int64_t k) const;
};

/// Nothing where the voxels of the map are no voxels of the grid [near_voxels, dicom_lattice.h], or leave it.
std::optional<VoxelMapping> mapping_of(const VolumeGeometry& grid, const VolumeGeometry& map);

/// Puts a label map whose voxels are voxels of a grid onto that, each layer, in the grid's axes; voxels that it lacks
/// are 0. False, with nothing changed, where voxels of a layer lie elsewhere.
bool put_on_grid(VolumeRead& map, const VolumeGeometry& grid);

}  // namespace homolog
