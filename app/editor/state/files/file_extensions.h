#pragma once

#include <string>
#include <vector>

namespace homolog {

// Last parts of file names, with dot.

/// Files of meshes with faces end so.
const std::vector<std::string>& mesh_extensions();
const std::vector<std::string>& volume_extensions();
/// Files that hold a shape of a model end so, without cases.
const std::vector<std::string>& shape_extensions();

}  // namespace homolog
