#pragma once

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The faces of a ring × sector mesh: vertex (ring, sector) has the index ring · sectors + sector, rings from the base,
/// sectors counter-clockwise seen from beyond the base; the apex is vertex rings · sectors; where the base is capped,
/// the vertex after it is the cap's middle. Outward oriented.
Triangles tube_triangles(int rings, int sectors, bool capped = false);

}  // namespace homolog
