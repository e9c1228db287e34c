#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// A day's work in one case, in a temporary folder: 5,000 gestures on 10,242 landmarks, 2,000 of them snaps of the
/// whole mesh. What they cost, how large the file is, and what it takes to open it and to undo everything. Errors: the
/// folder cannot be written to, cancelled.
Result<Json> case_figures(Progress& progress);

}  // namespace homolog
