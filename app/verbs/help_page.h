#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// The full name of a verb: "study make".
std::string full_name(const CLI::App& verb);

/// The verb that was given, of verbs of verbs the last; else the program itself.
const CLI::App* verb_given(const CLI::App& app);

/// Gives every verb of the program a help page: types in words ("N (1 to 1024)"), and examples. `app` has all verbs.
void dress_help(CLI::App& app);

}  // namespace homolog
