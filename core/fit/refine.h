#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/case/action.h"

namespace homolog {

struct Refinement {
  SetPoints edit;
  std::vector<std::string> warnings;  ///< each a sentence
};

/// Moves the vertices of the shown mesh along its own surface to where the template has them. For that the template is
/// fitted to this surface (fit_to_boundary), with the landmarks placed in the image. A pull does not say where along
/// the surface a vertex belongs; the whole surface and a few landmarks do. The surface itself stays, apart from what
/// its triangles cut off (some hundredths of a mm on average, more at a sharp edge), and so do the rims of an open
/// mesh. Confirmed vertices stay where they are. Errors: no mesh; fit_to_boundary's.
Result<Refinement> refine(const Document& document, Progress* progress = nullptr);

}  // namespace homolog
