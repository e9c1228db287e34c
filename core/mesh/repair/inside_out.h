#pragma once

#include <optional>
#include <string>

#include "core/mesh/topology.h"

namespace homolog {

/// "its faces look inward, …" with the remedy, where a mesh is inside out, or a part of it that lies in no other part;
/// none where it is not. An open surface that is so flat that it has no inside gives none.
std::optional<std::string> inside_out(const Mesh& mesh);

}  // namespace homolog
