#pragma once

#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

struct Rasterising {
  double spacing_mm = 1;  ///< of the voxels; larger where the grid would hold more than 16 million
  double wall_mm = 0;     ///< thinner walls and struts are made so thick
};

/// What a mesh of `vertices` vertices shows: voxels of a quarter of its mean edge, walls of an edge.
Rasterising rasterising_for(const Mesh& surface, int vertices);

/// What a surface encloses as a label map (uint8, 1 inside), for surfaces that no mesh operation can put in order. Each
/// part counts by itself, so that overlaps and cavities are inside; a voxel is inside a part if two of three rays along
/// the axes say so. Holes count as closed flat. Walls that fall between voxels are kept by the voxels that they pass.
Volume rasterised(const Mesh& surface, const Rasterising& how);

}  // namespace homolog
