#pragma once

#include "app/verbs/fit/fit_case.h"

namespace homolog {

/// Fits a template to many label maps or surfaces, and writes a mesh for each, and a study of their cases where the
/// verb makes cases. Where it is asked for, each is fitted once more by way of others. Errors: two cases of one name,
/// an output that is read, none that could be fitted.
Result<Report> fit_many(FitJob options, const FitShared& shared, Progress& progress);

}  // namespace homolog
