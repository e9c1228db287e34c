#pragma once

#include "app/editor_options.h"

namespace homolog {

/// The editor in a window, until it is closed. Returns the program's exit status; without a display it says so on
/// stderr and returns 1.
int run_editor(const EditorOptions& options);

}  // namespace homolog
