#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh/topology.h"
#include "core/structures/fitting/keep_apart.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A structure to write into a label map.
struct MeshOfSegment {
  Segment segment;
  Mesh mesh;
};

struct MapOfMeshes {
  VolumeRead map;
  /// Voxels that two meshes hold which may not overlap; of `map_in_layers` those that two meshes of one layer hold.
  std::size_t contested_voxels = 0;
};

/// A label map with names and colours. Structures lie in the layers that their segments say; within a layer a voxel
/// that several meshes hold goes to the first of them. So it does for those of two layers that lie `apart` all the same
/// (by their places among the meshes). Layers that no mesh is of are left out.
MapOfMeshes map_of_meshes(const std::vector<MeshOfSegment>& meshes, const VolumeGeometry& grid,
                          std::span<const MeshPair> apart = {});

/// The same with all voxels of each mesh: one that overlaps another of its layer lies in the first layer in which it
/// overlaps none and its value is free.
MapOfMeshes map_in_layers(const std::vector<MeshOfSegment>& meshes, const VolumeGeometry& grid);

}  // namespace homolog
