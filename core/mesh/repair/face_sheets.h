#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/mesh/repair/mesh_repair.h"

namespace homolog {

using Corners3 = std::array<std::int32_t, 3>;

/// Faces as a file has them.
struct Soup {
  Points points;
  std::vector<Corners3> faces;
};

/// A manifold of the same faces: joined in pairs across their edges, turned so that neighbours look the same way, and
/// parted everywhere else. Vertices keep their order; those that are parted are drawn a little apart. Faces must name
/// three different vertices and no three of them twice. Counts what it did.
Soup parted_sheets(Soup soup, MendedFaults& mended);

}  // namespace homolog
