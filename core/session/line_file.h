#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/files/open_file.h"
#include "core/base/result.h"

namespace homolog {

/// A file of lines that is read piece by piece, however large it is. Stays what it was opened as: where another file
/// takes its name, or its name is taken away, this one is read on.
class LineFile {
 public:
  /// Errors: absent, unreadable, no file of a disk (a folder, a pipe).
  static Result<std::shared_ptr<const LineFile>> open(const std::filesystem::path& path);
  /// Takes a file that is open already.
  LineFile(std::filesystem::path path, OpenFile file) : path_(std::move(path)), file_(std::move(file)) {}

  const std::filesystem::path& path() const { return path_; }
  const OpenFile& file() const { return file_; }
  /// Bytes at a place. Errors: the file ends before, a disk error.
  Result<std::string> read(std::uint64_t at, std::uint64_t bytes) const;
  /// Calls `visit(line, at, ended)` for each line, without its line feed, with where it begins; the last one may lack
  /// its line feed: it is not `ended`. The line is gone when `visit` returns; its error ends the reading. Errors: a
  /// disk error, a line above 1 GiB.
  using Visit = std::function<Result<void>(std::string_view line, std::uint64_t at, bool ended)>;
  Result<void> for_each_line(const Visit& visit) const;

 private:
  Result<std::size_t> read_some(char* into, std::size_t most, std::uint64_t at) const;

  std::filesystem::path path_;
  OpenFile file_;
};

}  // namespace homolog
