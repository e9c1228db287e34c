#pragma once

#include "core/base/processes/progress.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// How fine a solid is.
struct SolidDetail {
  double spacing_mm = 1;  ///< size of the voxels; larger where the grid would hold more than 16 million
  double wall_mm = 0;     ///< walls and struts below 1.25 times this grow by so much; at least two voxels
};

/// The detail that a mesh of `vertices` vertices shows: voxels of a quarter of its mean edge, walls of an edge.
SolidDetail solid_detail(const Mesh& surface, int vertices);

struct SolidVoxels {
  Volume label_map;    ///< uint8, 1 inside
  double wall_mm = 0;  ///< walls and struts below 1.25 times this grew by so much
};

/// The voxels that a surface encloses, for surfaces that no mesh operation can put in order. Each part counts by
/// itself, so that overlaps and cavities are inside; a voxel is inside a part if two of three rays along the axes say
/// so. Holes count as closed flat. Walls that fall between voxels are kept by the voxels that they pass. The surface
/// must have an extent. Cancelled: something of it.
SolidVoxels solid_voxels(const Mesh& surface, const SolidDetail& detail, Progress* progress = nullptr);

}  // namespace homolog
