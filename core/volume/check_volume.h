#pragma once

#include "core/base/result.h"
#include "core/volume/volume.h"

namespace homolog {

// Functions that a program calls first check what they are given by these. What they call in turn trusts it.

/// Errors: an axis without voxels, no frame, as many values as the grid does not hold; a grid without a place or an
/// extent in space.
Result<void> check_volume(const Volume& volume);
/// The same of a volume that is looked at in one frame, counted from 0. Errors: no such frame; check_volume's.
Result<void> check_frame_of(const Volume& volume, int frame);

}  // namespace homolog
