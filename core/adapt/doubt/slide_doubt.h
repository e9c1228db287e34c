#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// How much of the doubt of a fit lies at each vertex: the mean over the vertices is 1. It is the variance that is left
/// of a smooth displacement once the surface is met: every place may go astray alike beforehand, and afterwards only
/// as the surface lets it slide. At a tip, an edge or a saddle it cannot slide far; where the surface is level, or
/// along a shaft or a crest, it can. [Rasmussen and Williams 2006, Eq. 2.24, of a Gaussian process on bumps, seen along
/// the normals at samples of the surface.] All 1 where nothing can be computed, as on a flat mesh. One thread.
VertexScalars shares_of_sliding(const Mesh& mesh);

}  // namespace homolog
