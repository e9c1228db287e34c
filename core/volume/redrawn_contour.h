#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/volume/contours.h"

namespace homolog {

/// A place on a curve.
struct PlaceOnContour {
  std::size_t piece = 0;   ///< it lies between the point of this number and the next
  double share = 0;        ///< share of the way to the next, 0…1
  Vec3 at = Vec3::Zero();  ///< LPS mm
};

/// The place of a curve that is nearest to `p`, LPS mm.
PlaceOnContour nearest_place(const Contour& curve, const Vec3& p);

/// A curve of which somebody drew a part anew: `stroke`, points in the curve's plane, LPS mm, takes the place of what
/// lies between where it begins and where it ends. Both must lie within `near_mm` of the curve; there it runs into the
/// curve. The larger area of a closed curve stays. From one end of an open curve to the other the stroke closes
/// it. Which way the curve runs stays. None: the stroke begins or ends elsewhere.
std::optional<Contour> redrawn_contour(const Contour& curve, const std::vector<Vec3>& stroke, double near_mm);

}  // namespace homolog
