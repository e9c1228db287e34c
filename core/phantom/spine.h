#pragma once

#include "core/phantom/implicit.h"

namespace homolog::phantom {

/// Solid of the mean lumbar vertebra: body, pedicles, laminae, processes. The body's centre is the origin; axes are the
/// patient's (LPS), lengths in mm.
double vertebra_solid(const Vec3& p);

/// Half the height of the body at its rim.
constexpr double body_half_height_mm = 13.5;
/// How far each endplate is hollowed at a place.
double endplate_hollow_mm(double x, double y);

/// Solid of the sacrum, which continues the vertebra's canal; its first body's centre is the origin.
double sacrum_solid(const Vec3& p);

/// Solid of a disc of even height around the origin, of which two endplates make a real one.
double disc_solid(const Vec3& p);
constexpr double disc_half_mm = 4.5;

/// From one vertebra to the next, in mm.
constexpr double vertebra_pitch_mm = 36;

/// Paints a straight lumbar spine through the origin, with one vertebra there and its copies above and below: canal
/// with nerve tissue, discs, bones with cortical shell. `grain` (about −1…1) mottles the spongy bone.
void paint_spine(Voxel& voxel, const Vec3& p, double grain);

}  // namespace homolog::phantom
