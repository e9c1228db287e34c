#pragma once

#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// The segmentation as voxels: `value` (1…32,767) where a voxel's centre is inside the mesh, exactly, else 0. One
/// frame; uint8 where the value fits, else int16.
Volume label_map(const Mesh& mesh, const VolumeGeometry& grid, int value = 1);

}  // namespace homolog
