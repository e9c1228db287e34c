#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Faces of a surface that look cut with a knife: flat, of some size, and with a sharp edge around them. Label maps of
/// scans that end within an organ have them, and so have vertebrae by nature. Each is a list of faces, in rising order.
/// `smallest_share`: of the surface's area.
inline constexpr double large_face_share = 0.03, small_face_share = 0.005;
std::vector<std::vector<std::int32_t>> flat_faces(const Mesh& surface, double smallest_share = large_face_share);

/// Tells which of a surface's flat faces (`flat`) are cuts through the organ, or patches over its holes: those where
/// the template looks elsewhere, and large ones where its normals spread and it is not flat too. The result has a value
/// for each face of the surface: 1 where it belongs to a cut, else 0. Empty where nothing is cut. `on_surface`: the
/// template placed, or better fitted; it tells what lies where. `placed`: its own form (n×3) under a similarity. All
/// LPS mm.
std::vector<std::uint8_t> cut_faces(const Mesh& surface, const std::vector<std::vector<std::int32_t>>& flat,
                                    const Mesh& on_surface, const Points& placed);

}  // namespace homolog
