#pragma once

#include <optional>

#include "core/mesh/mesh_io.h"

namespace homolog {

/// Notes in a mesh of a cine which frame it belongs to, counted from 0; kept by PLY only, as the comment
/// `homolog.frame K`.
void note_frame(MeshFile& mesh, int frame);

/// The frame of a cine that a mesh says it belongs to; none where it says nothing.
std::optional<int> noted_frame(const MeshFile& mesh);

}  // namespace homolog
