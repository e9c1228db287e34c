#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh/topology.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A structure to write into a label map.
struct MeshOfSegment {
  Segment segment;
  Mesh mesh;
};

struct MapOfMeshes {
  VolumeRead map;
  std::size_t contested_voxels = 0;  ///< that two meshes of one layer hold
};

/// A label map with names and colours. Structures lie in the layers that their segments say; within a layer a voxel
/// that several meshes hold goes to the first of them. Layers that no mesh is of are left out.
MapOfMeshes map_of_meshes(const std::vector<MeshOfSegment>& meshes, const VolumeGeometry& grid);

}  // namespace homolog
