#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/template/template.h"

namespace homolog {

/// The start of a refinement. All n×3 in LPS mm.
struct RefineStart {
  Points points;                          ///< the mesh's vertices, in the template's numbering; its surface stays
  Points placed;                          ///< the template as placed: what "turned" is measured against
  Similarity placement;                   ///< the template's placement
  std::map<std::string, Vec3> landmarks;  ///< named places on the organ
  VertexScalars stiffness;                ///< w_i
  VertexScalars confirmed;                ///< 0 free … 1 held, per vertex; empty: all free
};

struct RefineResult {
  Points points;
  std::vector<std::string> warnings;  ///< each a sentence
};

/// Moves the vertices of a mesh along its own surface to where the template has them. For that the template is fitted
/// to this surface (fit_to_boundary), with the landmarks. A pull does not say where along the surface a vertex belongs;
/// the whole surface and a few landmarks do. The surface itself stays, apart from what its triangles cut off (some
/// hundredths of a mm on average, more at a sharp edge), and so do the rims of an open mesh. Confirmed vertices stay
/// where they are. Errors: fit_to_boundary's.
Result<RefineResult> refine(const Template& the_template, const RefineStart& start, Progress* progress = nullptr);

}  // namespace homolog
