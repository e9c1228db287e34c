#pragma once

#include <string>
#include <vector>

namespace homolog {

// Last parts of file names, with dot.

/// Of meshes with faces.
const std::vector<std::string>& mesh_extensions();
const std::vector<std::string>& volume_extensions();
/// Of files that hold a shape of a model, without cases.
const std::vector<std::string>& shape_extensions();

}  // namespace homolog
