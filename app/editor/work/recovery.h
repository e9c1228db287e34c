#pragma once

#include <filesystem>
#include <vector>

#include "app/editor/state/dialogs.h"

namespace homolog {

/// The cases to offer again, newest first, each with what it is; see unsaved_cases().
std::vector<RecoverDialog::Found> cases_to_recover();

/// Removes a journal of an unsaved case that holds its first line alone: it was left as it was opened. Any other file
/// stays.
void remove_without_edits(const std::filesystem::path& journal);

/// Does so with those that a killed program left behind.
void remove_all_without_edits();

}  // namespace homolog
