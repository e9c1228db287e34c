#pragma once

#include "app/verbs/fit_case.h"

namespace homolog {

/// Fits to contours that somebody drew, alone, or together with a label map or an image: these say where the boundary
/// lies between the contours. Writes the mesh and reports `contours_mm`. Errors: the readers'; several structures and
/// none named; a structure without contours; contours of another scan than the image; the fit's, the writer's.
Result<Report> fit_contours(const FitJob& options, const FitShared& shared, Progress& progress);

}  // namespace homolog
