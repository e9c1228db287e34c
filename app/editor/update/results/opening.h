#pragma once

#include "app/editor/update/editing.h"

namespace homolog {

// The editor takes in cases, images and templates once they are read.

/// Shows a case, whose journal is the caller's matter.
void start_session(Editing& editing, EditSession session);
void show_opened(Editing& editing, Opened opened);
/// Goes to the place that the case was opened for, where it was for one.
void show_repair(Editing& editing);

}  // namespace homolog
