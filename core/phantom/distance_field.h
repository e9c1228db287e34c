#pragma once

#include <vector>

#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog::phantom {

/// The distance from the nearest of several closed surfaces in mm at every voxel centre, negative inside one; i
/// fastest. Exact within `reach_mm` of a surface, elsewhere not nearer to zero than that.
std::vector<float> distance_field(const std::vector<Mesh>& meshes, const VolumeGeometry& grid, double reach_mm);

}  // namespace homolog::phantom
