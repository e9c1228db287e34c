#pragma once

#include "core/phantom/spine_meshes.h"
#include "core/volume/volume.h"

namespace homolog::phantom {

/// A CT without contrast agent of a subject's spine and of what lies around it. Cancelled, it is empty or not whole.
Volume spine_image(const SpineMeshes& spine, int subject, const VolumeGeometry& grid, const Progress* progress);

}  // namespace homolog::phantom
