#pragma once

#include <cmath>
#include <span>
#include <type_traits>

#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// Whether a voxel of a label map has a label; floats are rounded, as labels_of() does.
template <class T>
bool has_label(T voxel, int label) {
  if constexpr (std::is_floating_point_v<T>)
    return std::rint(voxel) == static_cast<T>(label);
  else
    return voxel == label;
}

/// The 0.5 isosurface of the voxels that equal `label` (1 inside, 0 outside, 0 beyond the grid), LPS mm, by marching
/// cubes: closed, manifold, outward oriented, whatever the handedness of the grid. Errors: the label does not occur.
Result<Mesh> mask_surface(const Volume& mask, int label, int frame = 0);

/// The surface where trilinear `values` (one a voxel of `grid`, i fastest) pass zero, negative inside, positive beyond
/// the grid: as mask_surface of the negative voxels, vertices where the values say. Errors: no value is negative.
Result<Mesh> zero_surface(std::span<const float> values, const VolumeGeometry& grid);

}  // namespace homolog
