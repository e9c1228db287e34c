#pragma once

#include "app/verbs/fit/fit_case.h"

namespace homolog {

/// `fit` with a template set: all its structures to each label map. Writes FOLDER/CASE/STRUCTURE.ply and
/// FOLDER/CASE.seg.nrrd, a case of each map with all its structures, FOLDER/CASE.homolog, and a study of them. Errors:
/// the set; the folder; no case could be fitted; cancelled.
Result<Report> fit_sets(const FitJob& options, Progress& progress);

}  // namespace homolog
