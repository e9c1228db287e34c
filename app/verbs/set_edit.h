#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// `set add` and `set rename`.
void add_set_edits(CLI::App& set, CommandLine& asked);

}  // namespace homolog
