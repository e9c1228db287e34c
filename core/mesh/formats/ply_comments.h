#pragma once

#include <string>
#include <string_view>

#include "core/mesh/mesh_io.h"

namespace homolog::formats {

/// Keeps what a comment of a header says: a landmark, a region, the stiffness base, or else the comment. One that
/// cannot be read is kept as a comment, with a warning. A record is left out.
void keep_comment(std::string_view comment, MeshFile& mesh);

/// Appends the lines of the header that keep stiffness base, regions, landmarks, comments and the record.
void write_comments(const MeshFile& mesh, std::string& bytes);

}  // namespace homolog::formats
