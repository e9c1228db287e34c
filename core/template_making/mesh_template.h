#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_io.h"

namespace homolog {

struct MeshTemplate {
  Mesh mesh;                           ///< closed, one component, numbered breadth-first, in the given mesh's frame
  SurfaceDistance to_mesh, from_mesh;  ///< from the template to the given surface, and back
  std::vector<std::string> warnings;   ///< what was mended, each a sentence
};

/// A reference mesh from an existing surface: vertices at (nearly) one place are made one, faces without area and all
/// but the largest part are left out, holes are closed flat, and `vertices` are spread evenly over it. Errors: no
/// faces, edges with more than two faces or faces that look both ways; cancelled.
Result<MeshTemplate> make_mesh_template(const MeshFile& surface, int vertices, Progress* progress = nullptr);

}  // namespace homolog
