#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// A day's work in one case, in a temporary folder: 5,000 gestures on 10,242 vertices, 2,000 of them snaps of the whole
/// mesh. Measures the time of gestures, the size of the file, and the time to open it and to undo everything. Errors:
/// the folder cannot be written to, cancelled.
Result<Json> case_figures(Progress& progress);

}  // namespace homolog
