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

/// Moves landmarks along the shown mesh's own surface to where the template has them: the template is fitted to that
/// surface as to any boundary (fit_to_boundary), with the landmarks placed in the image. A pull says nothing of where
/// along the surface a landmark belongs; the whole surface together with a few landmarks does. The surface itself
/// stays, but for what its triangles cut off (some hundredths of a mm on average, more at a sharp edge), and so do the
/// loops of an open one. Confirmed landmarks stay where they are. Errors: no mesh; fit_to_boundary's.
Result<Refinement> refine(const Document& document, Progress* progress = nullptr);

}  // namespace homolog
