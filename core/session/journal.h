#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>

#include "core/base/files/files.h"
#include "core/base/result.h"
#include "core/session/line_file.h"

namespace homolog {

/// An append-only file of lines, locked against other programs while open. An appended line is on the disk, or it is
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
  /// Brings to the disk what was appended without. Errors: the disk fails, or did before and still does; append() tries
  /// again.
  Result<void> sync();
  const std::filesystem::path& path() const { return lines_->path(); }
  /// For reading; lives on when the journal is closed.
  const std::shared_ptr<const LineFile>& file() const { return lines_; }
  std::uint64_t bytes() const { return bytes_; }
  /// Whether `path` is this very file.
  bool is_at(const std::filesystem::path& path) const;

  /// The fate of the file while it was open.
  enum class Fate {
    as_left,           ///< as this program left it, or as a disk that fails left it
    touched,           ///< somebody wrote to it, or changed its attributes
    replaced,          ///< another file has its name
    deleted,           ///< no file has its name
    deleted_with_all,  ///< its folder is gone too, or another disk lies there
    read_only          ///< its disk takes no more writes
  };
  Fate fate();
  /// A touched file holds what this program wrote after all.
  void accept_touch() { remember(); }
  /// The file is another program's now: nothing more is written to it, not even at the end.
  void let_go();

 private:
  explicit Journal(std::shared_ptr<const LineFile> lines, std::uint64_t bytes);
  const OpenFile& open_file() const { return lines_->file(); }
  Result<void> unharmed() const;
  std::uint64_t synced_bytes() const { return bytes_ - unsynced_.size(); }
  void remember();
  void take_back();
  void mend();
  bool write_unsynced_again();

  std::shared_ptr<const LineFile> lines_;
  std::uint64_t bytes_;
  std::string unsynced_;          ///< accepted lines, kept until they are on the disk
  bool sync_failed_ = false;      ///< since `unsynced_` was written, which may be lost
  bool read_only_ = false;        ///< the disk refused a write as such
  const char* broken_ = nullptr;  ///< why nothing can be appended until mend() succeeds; null: it can
  std::uint64_t most_bytes_ = 0;  ///< bytes of the broken file that this program may have left there
  std::int64_t changed_ns_ = 0;   ///< when the file or its attributes changed last, as this program knows it
  std::uint64_t folder_disk_ = 0;
};

}  // namespace homolog
