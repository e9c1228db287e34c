#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Faces of a surface that look cut with a knife: flat, of some size, and with a sharp edge around them. Label maps of
/// scans that end within an organ have them, and so have vertebrae by nature. Each is a list of faces, in rising order.
std::vector<std::vector<std::int32_t>> flat_faces(const Mesh& surface);

/// Tells which of a surface's flat faces (`flat`) are cuts through the organ: those where the placed template is not
/// flat too, and where its normals nearby spread or point elsewhere. Of each face of the surface: 1 where it belongs to
/// a cut, else 0. Empty where nothing is cut. Both meshes LPS mm.
std::vector<std::uint8_t> cut_faces(const Mesh& surface, const std::vector<std::vector<std::int32_t>>& flat,
                                    const Mesh& placed_template);

}  // namespace homolog
