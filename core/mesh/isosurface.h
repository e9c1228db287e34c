#pragma once

#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// The 0.5 isosurface of the voxels that equal `label` (1 inside, 0 outside, 0 beyond the grid), LPS mm, by marching
/// cubes: closed, manifold, outward oriented, whatever the handedness of the grid. Errors: the label does not occur.
Result<Mesh> mask_surface(const Volume& mask, int label, int frame = 0);

}  // namespace homolog
