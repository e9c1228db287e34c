#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/session/session.h"

namespace homolog {

/// How the name of every case file ends.
inline constexpr const char* case_extension = ".homolog";
bool is_case_file(const std::filesystem::path& file);

/// Scheme options that override what a case file says, and how it is read.
struct ReplayOptions {
  std::optional<Scheme> scheme;
  std::optional<int> paper_events;
  std::optional<double> even_spacing;
  std::string volume_source;  ///< the image's file now; empty: as the file says
  /// Begin at the last checkpoint that holds, which gives the same to the last bit; else every line is played. Options
  /// that override the scheme play every line anyway.
  bool from_checkpoint = true;
  /// For who wants the shapes alone: the image is left out where they do not depend on it [shapes_need_image], and else
  /// read without its voxels where its format has them apart.
  bool shapes_alone = false;
  /// Where a line cannot be played, the case is read as it was before that line, and CaseRead::fault says why.
  bool up_to_bad_line = false;
  HistoryLimits limits;
  Progress* progress = nullptr;
};

struct CaseRead {
  EditSession session;
  std::vector<std::string> warnings;  ///< a dropped torn last line
  std::uint64_t whole_bytes = 0;      ///< up to and including the last whole line that was read
  std::string fault = {};             ///< why the next line cannot be played, as a sentence; empty: all were played
};

/// Reads a case file, loads its volume and template, and plays its lines. Errors: a line that is no action (its number
/// is named) where the options do not ask for what stands before it, read_header's.
Result<CaseRead> read_case(const std::filesystem::path& path, const ReplayOptions& options = {});

/// Whether the shapes of a case depend on more of its image than its name: the case has several frames or structures,
/// or its first line does not say where the template lies. Also true for a file that cannot be read.
bool shapes_need_image(const std::filesystem::path& path);

/// read_case, then opens the file's journal so that every further action is appended to it. `volume_source`: where the
/// image lies now, which the file's first line says from then on; as it says where empty. With `up_to_bad_line` a case
/// with a line that cannot be played is read up to it [ReplayOptions]; it has no journal then, and the file stays as it
/// is. Errors: read_case's, unwritable, open in another program.
Result<CaseRead> open_case(const std::filesystem::path& path, Progress* progress = nullptr,
                           const std::string& volume_source = {}, const HistoryLimits& limits = {},
                           bool up_to_bad_line = false);

/// A new case whose journal is `path`; an existing file is replaced. An image alone will do. Errors: a structure
/// without a sound template; a name that is no UTF-8; unwritable. `record`: how a verb makes it; empty: none does.
Result<EditSession> create_case(Document initial, const std::filesystem::path& path, const HistoryLimits& limits = {},
                                std::string record = {});

/// Copies the case so far to `path` (paths in its first line made relative to the new folder, every other line as it
/// is) and goes on there. A journal in unsaved_folder() is removed then. Works also where the case's own file was
/// deleted or replaced under it.
Result<void> save_case_as(EditSession& session, const std::filesystem::path& path);

}  // namespace homolog
