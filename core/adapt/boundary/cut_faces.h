#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Faces of a surface that look cut with a knife: flat, of some size, and with a sharp edge around them. Label maps of
/// scans that end within an organ have them, and so have vertebrae by nature. Each is a list of faces, in rising order.
std::vector<std::vector<std::int32_t>> flat_faces(const Mesh& surface);

/// Which faces of a surface belong to those of its flat faces that are cuts through the organ, 1 each: the placed
/// template is not flat there, and its surface nearby looks other ways. Empty where none is. Both meshes LPS mm.
std::vector<std::uint8_t> cut_faces(const Mesh& surface, const std::vector<std::vector<std::int32_t>>& flat,
                                    const Mesh& placed_template);

}  // namespace homolog
