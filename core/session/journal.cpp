#include "core/session/journal.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

namespace homolog {

namespace {

namespace fs = std::filesystem;

constexpr const char* line_is_left = "ends in a refused line that could not be removed";
constexpr const char* not_on_the_disk = "could not be written to the disk";
constexpr const char* changed_by_another = "was changed by another program while it was open";
constexpr auto blink = std::chrono::milliseconds(10);

Error open_elsewhere(const fs::path& path) {
  return {path.string(), "is open in another program; close it there, or open a copy"};
}

/// The disk that a file's folder is on; none where the folder is not there.
std::optional<std::uint64_t> disk_of_folder(const fs::path& file) {
  const fs::path parent = file.parent_path();
  const auto folder = status_of(parent.empty() ? "." : parent);
  return folder ? std::optional(folder->disk) : std::nullopt;
}

}  // namespace

Result<std::unique_ptr<Journal>> Journal::create(const fs::path& path, const Write& write, const Journal* mine,
                                                 Readers readers) {
  // A case that another program has open must not be replaced under it.
  if (!(mine != nullptr && mine->is_at(path)) && in_use(path)) return fail(open_elsewhere(path));
  if (auto written = write_whole_file(path, write, readers); !written) return fail(written.error());
  return open(path);
}

Result<std::unique_ptr<Journal>> Journal::open(const fs::path& path) {
  auto opened = OpenFile::open(path, OpenFile::For::appending);
  if (!opened) {
    return fail(path.string(), std::string("cannot be opened for writing (") + std::strerror(opened.error()) +
                                   "); make it writable or save the case elsewhere");
  }
  auto lines = std::make_shared<const LineFile>(path, std::move(*opened));
  const OpenFile& file = lines->file();
  const auto status = file.status();
  if (!status || status->kind != FileStatus::Kind::file)
    return fail(path.string(), "is no file that a case could be kept in; choose another name");
  // Who only asks whether it is in use holds it for the blink of an eye.
  for (int attempts = 5; !file.lock(); std::this_thread::sleep_for(blink))
    if (--attempts == 0) return fail(open_elsewhere(path));
  return std::unique_ptr<Journal>(new Journal(std::move(lines), status->bytes));
}

Journal::Journal(std::shared_ptr<const LineFile> lines, std::uint64_t bytes)
    : lines_(std::move(lines)), bytes_(bytes), folder_disk_(disk_of_folder(lines_->path()).value_or(0)) {
  remember();
}

Journal::~Journal() {
  mend();  // else a line that was refused would be there when the case is opened
  if (unsynced() && open_file().sync() != 0) write_unsynced_again();
  open_file().unlock();  // the file may be read on
}

bool Journal::in_use(const fs::path& path) {
  const auto file = OpenFile::open(path, OpenFile::For::reading);
  return file && file->is_locked();
}

bool Journal::is_at(const fs::path& path) const {
  const auto here = open_file().status(), there = status_of(path);
  return here && there && here->is_same_file(*there);
}

Result<void> Journal::keep_first(std::uint64_t keep_bytes) {
  if (bytes_ == keep_bytes) return {};  // a whole file is left alone, its time of change too
  int error = open_file().cut_to(keep_bytes);
  if (error == 0) error = open_file().sync();
  if (error != 0)
    return fail(path().string(),
                std::string("cannot be written (") + std::strerror(error) + "); save the case elsewhere");
  bytes_ = keep_bytes;
  remember();
  return {};
}

void Journal::remember() {
  if (const auto here = open_file().status()) changed_ns_ = here->changed_ns;
}

Journal::Fate Journal::fate() {
  mend();
  const auto here = open_file().status(), there = status_of(path());
  if (!there) return disk_of_folder(path()) == folder_disk_ ? Fate::deleted : Fate::deleted_with_all;
  if (!here || !here->is_same_file(*there)) return Fate::replaced;
  if (read_only_ || open_file().is_on_read_only_disk()) return Fate::read_only;
  if (broken_ != nullptr) return broken_ == changed_by_another ? Fate::touched : Fate::as_left;
  return here->bytes == bytes_ && here->changed_ns == changed_ns_ ? Fate::as_left : Fate::touched;
}

void Journal::let_go() {
  unsynced_.clear();
  sync_failed_ = false;
  broken_ = nullptr;
}

Result<void> Journal::unharmed() const {
  const auto refused = [this](const std::string& what) {
    return fail(path().string(), what + ", so the edit was not made; save the case elsewhere");
  };
  if (broken_ != nullptr) return refused(broken_);
  if (!is_at(path())) return refused("was deleted, moved or replaced while it was open");
  if (const auto here = open_file().status(); !here || here->bytes != bytes_) return refused(changed_by_another);
  return {};
}

Result<void> Journal::append(std::string_view lines, bool sync) {
  mend();
  if (auto fit = unharmed(); !fit) return fit;
  if (!sync)
    unsynced_.reserve(unsynced_.size() + lines.size());  // memory that is short is noticed before the disk changes
  int error = open_file().append(lines);
  if (error == 0 && sync) {
    error = open_file().sync();
    sync_failed_ = sync_failed_ || error != 0;
  }
  if (error == 0) {
    bytes_ += lines.size();
    remember();
    if (sync)
      unsynced_.clear();
    else
      unsynced_ += lines;
    return {};
  }
  most_bytes_ = bytes_ + lines.size();
  take_back();
  remember();
  const std::string what = std::string("could not be written (") + std::strerror(error) + "), so the edit was not made";
  read_only_ = error == EROFS;  // a disk that failed may not say so of itself
  if (read_only_) return fail(path().string(), what + "; make it again, and the case goes on as an unsaved one");
  if (broken_ != nullptr && !unsynced_.empty())
    return fail(path().string(), what + ", and the last ones are shown but not saved; save the case elsewhere");
  return fail(path().string(), what + "; free some space or save the case elsewhere");
}

/// Leaves the lines that were accepted, all of them on the disk; where the disk fails, `broken_` says how.
void Journal::take_back() {
  broken_ = nullptr;
  if (!sync_failed_ || unsynced_.empty()) {
    if (open_file().cut_to(bytes_) != 0) {
      broken_ = line_is_left;
      return;
    }
    sync_failed_ = open_file().sync() != 0;
    if (!sync_failed_) unsynced_.clear();
  }
  if (unsynced_.empty())
    sync_failed_ = false;  // nothing is there that it could have lost
  else if (!write_unsynced_again())
    broken_ = not_on_the_disk;
}

/// The disk may let itself be written by now. A file that another program made longer or shorter stays as it is.
void Journal::mend() {
  const auto here = broken_ == nullptr ? std::nullopt : open_file().status();
  if (!here) return;
  if (here->bytes < synced_bytes() || here->bytes > most_bytes_) {
    broken_ = changed_by_another;
    return;
  }
  sync_failed_ = sync_failed_ || here->bytes < bytes_;  // missing lines are written again
  take_back();
  remember();
}

/// After a sync that failed the system may have dropped what it held of the file, and the next sync succeeds without
/// it. So it is written anew.
bool Journal::write_unsynced_again() {
  const OpenFile& file = open_file();
  if (file.cut_to(synced_bytes()) != 0 || file.append(unsynced_) != 0 || file.sync() != 0) return false;
  unsynced_.clear();
  sync_failed_ = false;
  return true;
}

Result<void> Journal::sync() {
  mend();
  if (broken_ != nullptr) return fail(path().string(), std::string(broken_) + "; save the case elsewhere");
  if (!unsynced()) return {};
  const int error = open_file().sync();
  if (error == 0) {
    unsynced_.clear();
    return {};
  }
  sync_failed_ = true;
  most_bytes_ = bytes_;
  const bool written = write_unsynced_again();
  remember();
  if (written) return {};
  broken_ = not_on_the_disk;
  return fail(path().string(), std::string("could not be written to the disk (") + std::strerror(error) +
                                   "), so the last edits are shown but not saved; save the case elsewhere");
}

}  // namespace homolog
