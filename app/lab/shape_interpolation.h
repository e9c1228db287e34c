#pragma once

#include <vector>

#include "core/adapt/contours/contour_samples.h"
#include "core/base/result.h"

namespace homolog {

/// The surface between closed curves in parallel planes by shape-based interpolation [Raya and Udupa 1990]: signed
/// distances to the curves within each plane, linear from plane to plane. Beyond the first and the last plane it
/// goes on as there for half of the planes' distance. LPS mm. Errors: fewer than two parallel planes.
Result<Mesh> interpolated_shape(const std::vector<DrawnContour>& contours, double voxel_mm = 0.75);

}  // namespace homolog
