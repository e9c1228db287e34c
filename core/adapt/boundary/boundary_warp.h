#pragma once

#include "core/adapt/target.h"
#include "core/placement/known_matches.h"

namespace homolog {

/// A placed template carried smoothly to a boundary and to landmarks: the displacement of space that is most likely
/// [Lüthi 2018, §4.1: Gaussian-process regression] given where landmarks belong and, at a few hundred vertices, how far
/// away the boundary is along its normal; across the normal nothing is known. Between the observations this is smoother
/// than Eq. 3 alone, whose forces say nothing along the surface. As far as it turns no triangle over. Below three
/// landmarks `placed` as it is: the boundary alone lets the whole slide along itself. The larger `roundness`
/// (0 … 1), the larger and wider displacements may be: the nearest boundary is seldom that of another part then. If the
/// boundary lacks parts, it should be 0, since a large displacement runs wild there. `placed`: n×3, LPS mm.
Points warp_to_boundary(const std::shared_ptr<const Topology>& topology, const Points& placed,
                        const KnownMatches& landmarks, double roundness, Target& target);

/// The same of an organ that is known to differ smoothly from its template, as over a thousand vertices see the
/// boundary: the likeliest displacement of `placed` says where along the boundary a vertex belongs. It is a quadratic
/// map of space, nearly free, and small bumps. `landmarks` may be none. `there`: the mesh on the boundary or near it,
/// from where the boundary is looked for; its points where the displacement would fold.
Points warp_along_boundary(const Mesh& there, const Points& placed, const KnownMatches& landmarks, Target& target);

}  // namespace homolog
