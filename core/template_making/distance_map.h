#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/volume.h"

namespace homolog {

/// For every voxel centre of `grid` the distance in mm to the nearest one where `set` is not 0 (0 there), exact
/// [Maurer, Qi and Raghavan 2003]. `set` has one value a voxel, i fastest, and must hold at least one.
std::vector<float> distance_to(const std::vector<std::uint8_t>& set, const VolumeGeometry& grid);

}  // namespace homolog
