#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/case/session.h"

namespace homolog {

/// Line 1 of a case file for this document: volume, template (paths relative to `folder`), placement, vertices,
/// connectivity hash, series UID, voxels, spacing and geometry hash.
std::string case_header(const Document& document, const std::filesystem::path& folder);

/// One line for an action, without line feed; numbers in the shortest form that reads back to the same double.
std::string action_line(const Action& action, bool joined = false);
/// Errors: no valid JSON (read_json), no known key, a value of the wrong kind; unknown keys beside known ones are
/// ignored (the file keeps them).
Result<EditStep> parse_action(const std::string& line);

/// Scheme options that override what a case file says.
struct ReplayOptions {
  std::optional<Scheme> scheme;
  std::optional<int> paper_events;
  std::optional<double> spacing;
  std::string volume_source;  ///< where the image lies now; as the file says where empty
  Progress* progress = nullptr;
};

struct CaseRead {
  EditSession session;
  std::vector<std::string> warnings;  ///< a dropped torn last line
  std::uintmax_t whole_bytes = 0;     ///< up to and including the last whole line
};

/// Reads a case file, loads its volume and template, and replays every line. Errors: a line that is no action (its
/// number is named), a missing volume or template, a mismatch of vertices, connectivity, series or geometry (both
/// values named).
Result<CaseRead> read_case(const std::filesystem::path& path, const ReplayOptions& options = {});

/// read_case, then opens the file's journal so that every further action is appended to it. `volume_source`: where the
/// image lies now, which the file's first line says from then on; as it says where empty.
/// Errors: read_case's, unwritable, open in another program.
Result<CaseRead> open_case(const std::filesystem::path& path, Progress* progress = nullptr,
                           const std::string& volume_source = {});

/// A new case whose journal is `path`; an existing file is replaced.
Result<EditSession> create_case(Document initial, const std::filesystem::path& path);

/// A name of its own in unsaved_folder() for a case that was not saved yet. Errors: the folder cannot be made.
Result<std::filesystem::path> new_unsaved_path();

/// A new case that was not saved yet: its journal lies at new_unsaved_path().
Result<EditSession> create_unsaved_case(Document initial);

/// Cases left in unsaved_folder() by a program that ended without saving, newest first: those that hold at least one
/// action and are not open in another program.
std::vector<std::filesystem::path> unsaved_cases();

/// Copies the journal so far to `path` (paths in its first line made relative to the new folder, every other line as it
/// is) and continues there. A journal in unsaved_folder() is removed then. The session must have a journal.
Result<void> save_case_as(EditSession& session, const std::filesystem::path& path);

}  // namespace homolog
