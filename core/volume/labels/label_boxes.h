#pragma once

#include <array>
#include <map>
#include <optional>

#include "core/volume/volume.h"

namespace homolog {

/// The voxels from `first` to `last`, both of them included.
struct VoxelBox {
  std::array<int, 3> first{}, last{};
};

/// The box of every label other than 0 of a frame; values are rounded to whole numbers.
std::map<int, VoxelBox> label_boxes(const Volume& label_map, int frame = 0);

/// The smallest box of voxels, at least one, that holds all of a box in mm and `margin` voxels around it; it ends where
/// the grid ends.
VoxelBox voxels_around(const Box& box_mm, const VolumeGeometry& grid, int margin);

/// A grid with the same voxels that reaches so far beyond its own that it holds a box in mm.
VolumeGeometry grid_over(const VolumeGeometry& grid, const Box& box_mm);

/// Which voxel of `grid`, counted on beyond its ends, the first one of `other` is; none where the voxels of both do not
/// coincide within a hundredth of a voxel.
std::optional<std::array<int, 3>> offset_in_grid(const VolumeGeometry& grid, const VolumeGeometry& other);

/// The part of a grid that a box of its voxels is.
VolumeGeometry part_of_grid(const VolumeGeometry& grid, const VoxelBox& box);

/// One frame of a volume within a box of voxels and `margin` voxels around it, as far as the volume has them.
Volume cropped(const Volume& volume, const VoxelBox& box, int margin, int frame = 0);

}  // namespace homolog
