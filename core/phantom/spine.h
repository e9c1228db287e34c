#pragma once

#include "core/phantom/implicit.h"

namespace homolog::phantom {

/// Solid of the mean lumbar vertebra: body, pedicles, laminae, processes. The body's centre is the origin; axes are the
/// patient's (LPS), lengths in mm.
double vertebra_solid(const Vec3& p);

/// From one vertebra to the next, in mm.
constexpr double vertebra_pitch_mm = 36;

/// Paints a straight lumbar spine through the origin, with one vertebra there and its copies above and below: canal
/// with nerve tissue, discs, bones with cortical shell. `grain` (about −1…1) mottles the spongy bone.
void paint_spine(Voxel& voxel, const Vec3& p, double grain);

}  // namespace homolog::phantom
