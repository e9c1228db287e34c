#pragma once

#include "core/mesh/geometry/surface_search.h"

namespace homolog {

/// g_i = exp(−(‖p_i − q‖² − d²_min) / 2σ²), 0 on sheets other than q's unless `through_space`; n values, the largest
/// is 1. d_min is the distance of the nearest vertex, so that g never vanishes on a coarse mesh [Erdt 2009, §2.2, Fig.
/// 2b]. `sigma_mm` is raised to half of `edge_mm` (the mean edge) where it is smaller.
VertexScalars gaussian_falloff(const Topology& topology, const Points& points, const SurfacePoint& q, double sigma_mm,
                               double edge_mm, bool through_space);

}  // namespace homolog
