#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// Places that correspond: where a placed shape has them and where they belong, k×3 each, LPS mm, row by row.
struct KnownMatches {
  Points from, to;
  VertexScalars noise_mm;  ///< how far each may be off where it belongs, every coordinate
};

/// Landmarks with the noise under which the displacements from `from` to `to` are likeliest, if organs differ from
/// their template as WarpKernel says [Rasmussen and Williams 2006, §5.4.1: marginal likelihood]; at least that of a
/// person who clicks with care, and that where they are one or two. Landmarks that contradict each other count less.
/// `placed`: the template under its similarity, n×3, LPS mm; `from`, `to`: k×3; `trust`: of each, 0 … 1; one that is
/// hardly trusted is noise.
KnownMatches known_matches(const Points& placed, const Points& from, const Points& to, const VertexScalars& trust);

}  // namespace homolog
