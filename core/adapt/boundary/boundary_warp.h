#pragma once

#include "core/adapt/boundary/boundary_search.h"

namespace homolog {

/// A placed reference carried smoothly to a boundary and to landmarks: the displacement of space that is most likely
/// [Lüthi 2018, §4.1: Gaussian-process regression] given where landmarks belong and, at a few hundred vertices, how far
/// away the boundary is along its normal; across the normal nothing is known. Between the observations this is smoother
/// than Eq. 3 alone, whose forces say nothing along the surface. As far as it turns no triangle over. Below three
/// landmarks `placed` as it is: the boundary alone lets the whole slide along itself. `placed`: n×3, LPS mm; `from`,
/// `to`: k×3 landmarks on it and where they belong; `trust`: of each, 0 … 1.
Points warp_to_boundary(const std::shared_ptr<const Topology>& topology, const Points& placed, const Points& from,
                        const Points& to, const VertexScalars& trust, BoundarySearch& search);

}  // namespace homolog
