#pragma once

#include <string>
#include <vector>

#include "core/mesh/mesh_io.h"

namespace homolog {

/// The comment by which a fitted mesh says why a person has to look at it.
std::string doubt_comment(const std::string& reason);
/// Takes that comment off: the mesh was changed since.
void forget_doubt(MeshFile& mesh);

/// Why a shape should not go into a model before somebody looked at it: its fit was doubtful or found the mirror image
/// (it says so itself, else its `doubt_mm` does), or faces cut each other or are turned. Empty: nothing is known
/// against it.
std::string doubt_of_shape(const MeshFile& mesh);

/// A shape with the reason.
struct DoubtfulShape {
  std::string name, reason;
  std::vector<std::string> study_keys{};  ///< keys of the study's cases that it is of [ShapeSource]
};

/// A sentence for each, and at the end what can be done. `left_out`: they were.
std::vector<std::string> doubt_warnings(const std::vector<DoubtfulShape>& shapes, bool left_out);

}  // namespace homolog
