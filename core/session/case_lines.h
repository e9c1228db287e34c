#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/session/journal.h"
#include "core/session/line_place.h"

namespace homolog {

/// All lines of a case but the first. Those of a file that is only read stay there. Those of a case that goes on are
/// kept in memory, also where a journal takes them: another program may destroy its file.
class CaseLines {
 public:
  CaseLines() = default;
  /// The lines of `file` between two places of it, counted from its begin; `check` is theirs.
  CaseLines(std::shared_ptr<const LineFile> file, std::uint64_t begin, std::uint64_t end, std::uint32_t check);

  /// Goes on in `journal`, which holds `first_line` (with its line feed) and all lines so far. Errors: the lines so far
  /// cannot be read; nothing has changed then.
  Result<void> write_to(std::unique_ptr<Journal> journal, std::string first_line);
  /// From now on no file takes the lines.
  void close_journal();
  Journal* journal() const { return journal_.get(); }

  /// Adds lines, one after the other, each with its line feed; gives where they begin. Errors: Journal::append's;
  /// nothing was added then.
  Result<std::uint64_t> append(std::string_view lines, bool sync = true);
  Result<std::string> read(const LinePlace& place) const;
  /// The first line of the file, empty where there is no file yet.
  Result<std::string> first_line() const;
  /// Writes all lines to `out`. Errors: those so far cannot be read.
  Result<void> copy_to(std::ostream& out) const;
  /// Whether a file holds the first line and all others, and nothing else. Only where a journal takes the lines.
  bool are_all_of(const std::filesystem::path& path) const;
  /// A checksum (CRC-32) of all lines so far.
  std::uint32_t check() const { return check_; }
  /// … and what it becomes when `bytes` are added.
  static std::uint32_t checked(std::uint32_t before, std::string_view bytes);

 private:
  std::uint64_t in_file() const { return end_ - begin_; }

  std::unique_ptr<Journal> journal_;
  std::shared_ptr<const LineFile> file_;  ///< the file that is only read
  std::uint64_t begin_ = 0, end_ = 0;     ///< bounds of the lines in it
  std::string first_line_;                ///< the journal's first line
  std::string in_memory_;                 ///< the lines behind those in `file_`
  std::uint32_t check_ = 0;
  bool open_ended_ = false;  ///< the last line lacks its line feed: a script wrote it
};

}  // namespace homolog
