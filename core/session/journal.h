#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>

#include "core/base/files.h"
#include "core/base/result.h"
#include "core/session/line_file.h"

namespace homolog {

/// An append-only file of lines, locked against other programs while open. What is appended is on the disk, or it is
/// refused and the file is as it was before.
class Journal {
 public:
  using Write = std::function<Result<void>(std::ostream&)>;
  /// Makes the file with what `write` gives (written whole, synced, renamed), or replaces one; then opens and locks it.
  /// `mine`: a journal that is open here already; its file may be replaced. `readers`: who may read it. Errors:
  /// unwritable, open in another program.
  static Result<std::unique_ptr<Journal>> create(const std::filesystem::path& path, const Write& write,
                                                 const Journal* mine = nullptr, Readers readers = Readers::as_usual);
  /// Opens an existing file and locks it; nothing is written yet. Errors: absent, unwritable, locked by another program
  /// (the sentence says so).
  static Result<std::unique_ptr<Journal>> open(const std::filesystem::path& path);
  /// Cuts off what follows the first `keep_bytes`: a torn line.
  Result<void> keep_first(std::uint64_t keep_bytes);
  /// Whether another program has the file open as its journal. Changes nothing.
  static bool in_use(const std::filesystem::path& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Appends whole lines. With `sync` they are on the disk when it returns; without, they are safe from all but a power
  /// cut, and on the disk as soon as later ones are, or after sync(). Errors: a full disk; a file that was deleted,
  /// replaced or changed by another program since; a file that an earlier failure left damaged and that still cannot be
  /// mended. Refused lines are taken out of the file at once; where the disk fails, when more is appended or at the
  /// end.
  Result<void> append(std::string_view lines, bool sync = true);
  /// Whether lines wait for sync(); not after the disk failed: the next lines that are appended bring them along.
  bool unsynced() const { return !unsynced_.empty() && broken_ == nullptr; }
  /// Brings to the disk what was appended without. Errors: the disk fails; append() tries again.
  Result<void> sync();
  /// The lines that wait for sync(), and where they begin. Where the disk failed, the file may hold
  /// something else there.
  std::string_view unsynced_lines() const { return unsynced_; }
  std::uint64_t synced_bytes() const { return bytes_ - unsynced_.size(); }
  const std::filesystem::path& path() const { return file_->path(); }
  /// For reading; lives on when the journal is closed.
  const std::shared_ptr<const LineFile>& file() const { return file_; }
  std::uint64_t bytes() const { return bytes_; }
  /// Whether lines can be added: no error where the file is as this program left it.
  Result<void> unharmed() const;
  /// Whether `path` is this very file.
  bool is_at(const std::filesystem::path& path) const;

 private:
  explicit Journal(std::shared_ptr<const LineFile> file, std::uint64_t bytes) : file_(std::move(file)), bytes_(bytes) {}
  void take_back();
  void mend();
  bool write_unsynced_again();

  std::shared_ptr<const LineFile> file_;
  std::uint64_t bytes_;
  std::string unsynced_;          ///< accepted lines, kept until they are on the disk
  bool sync_failed_ = false;      ///< since `unsynced_` was written, which may be lost
  const char* broken_ = nullptr;  ///< why nothing can be appended until mend() succeeds; null: it can
  std::uint64_t most_bytes_ = 0;  ///< of the broken file: what this program may have left there
};

}  // namespace homolog
