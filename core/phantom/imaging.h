#pragma once

#include <functional>

#include "core/base/processes/progress.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog::phantom {

/// Whether a phantom is no longer wanted; `progress` may be null.
inline bool is_cancelled(const Progress* progress) {
  return progress != nullptr && progress->cancelled();
}

/// A CT of the scene: `hounsfield` of every voxel centre (LPS mm), grain of deviation `noise_hu` added, int16.
/// Cancelled, the further slices are 0.
Volume ct_image(const VolumeGeometry& grid, const std::function<double(const Vec3& p_mm)>& hounsfield, double noise_hu,
                std::uint64_t seed, const Progress* progress = nullptr);

/// Grid of isotropic voxels that fills `box`; `spacing_mm` ≤ 0 takes `usual_mm`, and less than 0.25 mm is not made.
VolumeGeometry grid_over(const Box& box, double spacing_mm, double usual_mm);

/// Grain as scanners leave it: normal, deviation 1, slightly blurred along i and j; i fastest. `index` tells slices and
/// frames apart.
std::vector<float> slice_grain(int width, int height, std::uint64_t seed, std::uint64_t index);

/// Fills range_min and range_max.
void note_range(Volume& volume);

}  // namespace homolog::phantom
