#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/mesh/mesh_io.h"

namespace homolog {

/// Makes a case of a shape that came from elsewhere, so that the editor can repair it: NAME.homolog in `folder` (made
/// where absent; NAME-2 where the name is taken), whose template is the shape as it came, NAME-imported.ply beside it.
/// Numbering is kept. `faces` are for a shape of points alone. Gives the case file. Errors: a name that is
/// none of a file in that folder, points alone without faces of their count, faces that are no manifold surface, a
/// folder that cannot be written to.
Result<std::filesystem::path> make_case_of_shape(const MeshFile& shape, const std::shared_ptr<const Topology>& faces,
                                                 const std::string& name, const std::filesystem::path& folder);

}  // namespace homolog
