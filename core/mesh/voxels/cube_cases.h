#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace homolog {

/// Marching cubes' 256 cases. Corner c of a cube has offset (c & 1, c >> 1 & 1, c >> 2) along (i, j, k); bit c of a
/// case says that it is inside. Edge e runs along axis e / 4 from offset 0 to 1; e & 1 and e >> 1 & 1 are its offsets
/// along the two other axes in cyclic order (axis + 1, axis + 2).
struct CubeCases {
  using Triangle = std::array<std::uint8_t, 3>;  ///< three edges, counter-clockwise seen from outside the surface
  std::array<std::vector<Triangle>, 256> triangles;
};

/// The cases, derived on first use by tracing closed loops over the cube's faces. If a face has two opposite corners
/// inside, they are kept apart, on both sides of the face alike, so that surfaces of neighbouring cubes always fit. No
/// triangle's inner edge lies in a face of the cube, so that every edge of the whole surface has exactly two triangles.
const CubeCases& cube_cases();

}  // namespace homolog
