#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace homolog {

/// An append-only file of lines, locked against other programs while open. A line is on the disk when `append`
/// returns.
class Journal {
 public:
  /// Makes the file with `first_lines` in it (written whole, synced, renamed), or replaces one; then opens and locks
  /// it.
  static Result<std::unique_ptr<Journal>> create(const std::filesystem::path& path, std::string_view first_lines);
  /// Opens an existing file and locks it; nothing is written yet. Errors: absent, unwritable, locked by another program
  /// (the sentence says so).
  static Result<std::unique_ptr<Journal>> open(const std::filesystem::path& path);
  /// Cuts off what follows the first `keep_bytes` (a torn line), and ends the last line where a script did not.
  Result<void> keep_first(std::uintmax_t keep_bytes);
  /// Whether another program has the file open as its journal. Changes nothing.
  static bool in_use(const std::filesystem::path& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Appends `line` and a line feed and syncs. On error (full disk) the file is as it was before.
  Result<void> append(std::string_view line);
  const std::filesystem::path& path() const { return path_; }

 private:
  Journal(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  std::filesystem::path path_;
  int descriptor_;
};

/// Where cases that were never saved keep their journals: $XDG_STATE_HOME/homolog, else ~/.local/state/homolog.
std::filesystem::path unsaved_folder();

}  // namespace homolog
