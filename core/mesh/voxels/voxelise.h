#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// 1 for every voxel whose centre is inside the mesh, exactly (parity of crossings along i, ties broken consistently),
/// else 0; i fastest. Boundary loops are capped flat.
std::vector<std::uint8_t> voxelise(const Mesh& mesh, const VolumeGeometry& grid);

}  // namespace homolog
