#pragma once

#include "app/editor/update/editing.h"

namespace homolog {

/// Closes the window as soon as all files are written; `without_study`: whatever becomes of the study's.
void quit_when_written(Editing& editing, bool without_study);
/// Does so now where nothing is left to write; asks where the study's file could not be written.
void update_quit(Editing& editing);

}  // namespace homolog
