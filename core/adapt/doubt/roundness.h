#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// How little the features of a shape say of where along its surface a place belongs: 0 where they say it, 1 of a round
/// organ, where many ways of lying on a boundary match alike. It goes by the sphericity: the surface of a ball of the
/// shape's volume over its own [Wadell 1935]. The rims of an open mesh are closed for the volume only, so that it
/// counts as rounder.
double roundness(const Mesh& mesh);

}  // namespace homolog
