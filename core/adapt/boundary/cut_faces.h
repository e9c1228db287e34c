#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Faces of a surface that look cut with a knife: flat, of some size, and with a sharp edge around them. Label maps of
/// scans that end within an organ have them, and so have vertebrae by nature. Each is a list of faces, in rising order.
std::vector<std::vector<std::int32_t>> flat_faces(const Mesh& surface);

/// Whether a flat face of `surface` is a cut through the organ: the placed template's surface near it faces other ways,
/// or lies elsewhere. Both meshes LPS mm.
bool is_cut(const Mesh& surface, const std::vector<std::int32_t>& flat_face, const Mesh& placed_template);

}  // namespace homolog
