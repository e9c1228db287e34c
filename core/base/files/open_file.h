#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/result.h"

namespace homolog {

/// The system's record of a file.
struct FileStatus {
  enum class Kind { file, folder, other };
  Kind kind = Kind::other;
  std::uint64_t disk = 0, number = 0;  ///< together they say which file it is
  std::uint64_t bytes = 0;
  std::int64_t changed_ns = 0;  ///< when its content or its attributes changed last

  bool is_same_file(const FileStatus& other) const { return disk == other.disk && number == other.number; }
};
/// Returns the status of the file that has a name, a link followed; nothing where there is none.
std::optional<FileStatus> status_of(const std::filesystem::path& path);

/// The error where a file is wanted and something else has the name. `kind`: what that is.
Error not_a_file(const std::filesystem::path& path, FileStatus::Kind kind);

/// Whether this process may read a file and not write it.
bool is_write_protected(const std::filesystem::path& path);

/// A file that is open at the system and closed at the end. If another file takes its name, it stays the one that
/// was opened. Errors are the system's numbers (errno), 0 for none, so that each caller can say what they mean to it.
class OpenFile {
 public:
  enum class For { reading, appending };
  /// Does not wait for the other end of a pipe, and makes no file.
  static tl::expected<OpenFile, int> open(const std::filesystem::path& path, For what);
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&&) = delete;
  ~OpenFile();

  std::optional<FileStatus> status() const;
  bool is_on_read_only_disk() const;
  /// How many bytes were read, at most `most`; 0 at the end of the file.
  tl::expected<std::size_t, int> read_at(char* into, std::size_t most, std::uint64_t at) const;
  int append(std::string_view bytes) const;
  /// Cuts off what follows the first `bytes`.
  int cut_to(std::uint64_t bytes) const;
  /// Brings the content to the disk.
  int sync() const;
  /// Locks the file against all others that lock it; false where one has done so.
  bool lock() const;
  /// Whether another has locked it. Any number may ask at once.
  bool is_locked() const;
  void unlock() const;

 private:
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace homolog
