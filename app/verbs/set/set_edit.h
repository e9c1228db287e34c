#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// `set add`, `set rename`, `set share`.
void add_set_edits(CLI::App& set, CommandLine& asked);

}  // namespace homolog
