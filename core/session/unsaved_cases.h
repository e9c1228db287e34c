#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/session/session.h"

namespace homolog {

/// The folder of the journals of cases that were never saved: $XDG_STATE_HOME/homolog, else ~/.local/state/homolog.
std::filesystem::path unsaved_folder();

/// A name of its own in unsaved_folder() for a case that was not saved yet. The folder is made where it is absent, and
/// closed to other users: images name patients. Errors: the folder cannot be made.
Result<std::filesystem::path> new_unsaved_path();

/// A new case that was not saved yet: its journal lies at new_unsaved_path(). It may have an image alone.
Result<EditSession> create_unsaved_case(Document initial);

/// A case left in unsaved_folder() by a program that ended without saving.
struct UnsavedCase {
  std::filesystem::path journal;
  std::string header;   ///< its first line
  bool edited = false;  ///< holds more than looks at frames and how it is shown
};

/// The unsaved case of a journal; none where it cannot be read.
std::optional<UnsavedCase> unsaved_case(const std::filesystem::path& journal);

/// Those that are not open in another program, newest first. Reads no further into each than its first step, so that a
/// thousand of them are listed at once.
std::vector<UnsavedCase> unsaved_cases();

/// How many steps a case holds, as Undo counts them: what was done in one go is one. Reads all of it.
std::size_t count_steps(const std::filesystem::path& journal);

}  // namespace homolog
