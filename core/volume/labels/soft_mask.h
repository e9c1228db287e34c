#pragma once

#include <optional>

#include "core/base/result.h"
#include "core/volume/volume.h"

namespace homolog {

/// Whether a frame is a soft mask as it stands: real values from 0 to 1, not all of them 0 or 1. Each is then the share
/// of its voxel that one structure has, or the probability of it.
bool is_soft(const Volume& mask, int frame);

/// The level of a soft mask's surface if none is asked for.
inline constexpr double usual_level = 0.5;

/// Takes the frame for a soft mask and moves its values so that the surface at `level` lies at 0.5: label 1 is what is
/// above it, and `Volume::soft` is set. `level` up to 1: of values from 0 to 1; above 1: of values from 0 to 255.
/// False, and nothing changed, for a mask of 0 and 1 alone. Errors: values beyond those.
Result<bool> make_soft(Volume& mask, int frame, double level);

}  // namespace homolog
