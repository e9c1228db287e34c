#pragma once

#include <limits>
#include <span>
#include <string>
#include <type_traits>

#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// In place of a label: every value but 0. No voxel has this one [rounded_label].
inline constexpr int every_label = std::numeric_limits<int>::min();

/// "label 3", as sentences name it.
inline std::string label_name(int label) {
  return label == every_label ? "the union of all labels" : "label " + std::to_string(label);
}

/// Whether a voxel of a label map has a label, which may be every_label; floats are rounded [rounded_label].
template <class T>
bool has_label(T voxel, int label) {
  if (label == every_label) return !has_label(voxel, 0);
  if constexpr (std::is_floating_point_v<T>)
    return rounded_label(static_cast<double>(voxel)) == label;
  else
    return voxel == label;
}

/// The 0.5 isosurface of the voxels that equal `label` (1 inside, 0 outside, 0 beyond the grid), LPS mm, by marching
/// cubes: closed, manifold, outward oriented, whatever the handedness of the grid. A soft mask gives the 0.5 isosurface
/// of its values. Errors: the label does not occur; those of check_frame_of.
Result<Mesh> mask_surface(const Volume& mask, int label, int frame = 0);

/// The surface where trilinear `values` (one a voxel of `grid`, i fastest) pass zero, negative inside, positive beyond
/// the grid: as mask_surface of the negative voxels, vertices where the values say. Errors: no value is negative; not a
/// value for each voxel.
Result<Mesh> zero_surface(std::span<const float> values, const VolumeGeometry& grid);

}  // namespace homolog
