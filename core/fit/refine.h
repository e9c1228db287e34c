#pragma once

#include "core/base/progress.h"
#include "core/case/action.h"

namespace homolog {

/// Moves landmarks along the shown mesh's own surface to where the template has them: the template is fitted to that
/// surface as to any boundary (fit_to_boundary), with the landmarks placed in the image. A pull says nothing of where
/// along the surface a landmark belongs; the whole surface together with a few landmarks does. The surface itself
/// stays, but for what its triangles cut off (a few hundredths of a mm). Confirmed landmarks stay where they are.
/// Errors: no mesh; fit_to_boundary's.
Result<SetPoints> refine(const Document& document, Progress* progress = nullptr);

}  // namespace homolog
