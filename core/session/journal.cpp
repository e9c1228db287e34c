#include "core/session/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

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

/// Writes all of `bytes`; 0 or the errno.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : EIO;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

Error open_elsewhere(const fs::path& path) {
  return {path.string(), "is open in another program; close it there, or open a copy"};
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/// The disk that a file's folder is on; none where the folder is not there.
std::optional<std::uint64_t> device_of_folder(const fs::path& file) {
  struct stat folder {};
  const fs::path parent = file.parent_path();
  if (::stat(parent.empty() ? "." : parent.c_str(), &folder) != 0) return std::nullopt;
  return folder.st_dev;
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
  const int descriptor = ::open(path.c_str(), O_RDWR | O_APPEND | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    return fail(path.string(), std::string("cannot be opened for writing (") + std::strerror(errno) +
                                   "); make it writable or save the case elsewhere");
  }
  auto file = std::make_shared<const LineFile>(path, descriptor);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    return fail(path.string(), "is no file that a case could be kept in; choose another name");
  // Who only asks whether it is in use holds it for the blink of an eye.
  for (int attempts = 5; ::flock(descriptor, LOCK_EX | LOCK_NB) != 0; std::this_thread::sleep_for(blink))
    if (--attempts == 0) return fail(open_elsewhere(path));
  return std::unique_ptr<Journal>(new Journal(std::move(file), static_cast<std::uint64_t>(status.st_size)));
}

Journal::Journal(std::shared_ptr<const LineFile> file, std::uint64_t bytes)
    : file_(std::move(file)), bytes_(bytes), folder_device_(device_of_folder(file_->path()).value_or(0)) {
  remember();
}

Journal::~Journal() {
  mend();  // else a line that was refused would be there when the case is opened
  if (unsynced() && ::fsync(file_->descriptor()) != 0) write_unsynced_again();
  ::flock(file_->descriptor(), LOCK_UN);  // the file may be read on
}

bool Journal::in_use(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool used = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0;
  ::close(descriptor);
  return used;
}

bool Journal::is_at(const fs::path& path) const {
  struct stat here {
  }, there{};
  return ::fstat(file_->descriptor(), &here) == 0 && ::stat(path.c_str(), &there) == 0 && same_file(here, there);
}

Result<void> Journal::keep_first(std::uint64_t keep_bytes) {
  if (bytes_ == keep_bytes) return {};  // a whole file is left alone, its time of change too
  int error = ::ftruncate(file_->descriptor(), static_cast<off_t>(keep_bytes)) == 0 ? 0 : errno;
  if (error == 0 && ::fsync(file_->descriptor()) != 0) error = errno;
  if (error != 0)
    return fail(path().string(),
                std::string("cannot be written (") + std::strerror(error) + "); save the case elsewhere");
  bytes_ = keep_bytes;
  remember();
  return {};
}

void Journal::remember() {
  struct stat here {};
  if (::fstat(file_->descriptor(), &here) == 0) changed_ = here.st_ctim;
}

Journal::Fate Journal::fate() {
  mend();
  struct stat here {
  }, there{};
  struct statvfs disk {};
  if (::stat(path().c_str(), &there) != 0)
    return device_of_folder(path()) == folder_device_ ? Fate::deleted : Fate::deleted_with_all;
  if (::fstat(file_->descriptor(), &here) != 0 || !same_file(here, there)) return Fate::replaced;
  if (read_only_ || (::fstatvfs(file_->descriptor(), &disk) == 0 && (disk.f_flag & ST_RDONLY) != 0))
    return Fate::read_only;
  if (broken_ != nullptr) return broken_ == changed_by_another ? Fate::touched : Fate::as_left;
  const bool as_left = static_cast<std::uint64_t>(here.st_size) == bytes_ && here.st_ctim.tv_sec == changed_.tv_sec &&
                       here.st_ctim.tv_nsec == changed_.tv_nsec;
  return as_left ? Fate::as_left : Fate::touched;
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
  struct stat here {};
  if (broken_ != nullptr) return refused(broken_);
  if (!is_at(path())) return refused("was deleted, moved or replaced while it was open");
  if (::fstat(file_->descriptor(), &here) != 0 || static_cast<std::uint64_t>(here.st_size) != bytes_)
    return refused(changed_by_another);
  return {};
}

Result<void> Journal::append(std::string_view lines, bool sync) {
  mend();
  if (auto fit = unharmed(); !fit) return fit;
  if (!sync)
    unsynced_.reserve(unsynced_.size() + lines.size());  // memory that is short is noticed before the disk changes
  const int descriptor = file_->descriptor();
  int error = write_all(descriptor, lines);
  if (error == 0 && sync && ::fsync(descriptor) != 0) {
    error = errno;
    sync_failed_ = true;
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
  const int descriptor = file_->descriptor();
  broken_ = nullptr;
  if (!sync_failed_ || unsynced_.empty()) {
    if (::ftruncate(descriptor, static_cast<off_t>(bytes_)) != 0) {
      broken_ = line_is_left;
      return;
    }
    sync_failed_ = ::fsync(descriptor) != 0;
    if (!sync_failed_) unsynced_.clear();
  }
  if (unsynced_.empty())
    sync_failed_ = false;  // nothing is there that it could have lost
  else if (!write_unsynced_again())
    broken_ = not_on_the_disk;
}

/// The disk may let itself be written by now. A file that another program made longer or shorter stays as it is.
void Journal::mend() {
  struct stat here {};
  if (broken_ == nullptr || ::fstat(file_->descriptor(), &here) != 0) return;
  const auto size = static_cast<std::uint64_t>(here.st_size);
  if (size < synced_bytes() || size > most_bytes_) {
    broken_ = changed_by_another;
    return;
  }
  sync_failed_ = sync_failed_ || size < bytes_;  // what is missing is written again
  take_back();
  remember();
}

/// After a sync that failed the system may have dropped what it held of the file, and the next sync succeeds without
/// it. So it is written anew.
bool Journal::write_unsynced_again() {
  const int descriptor = file_->descriptor();
  if (::ftruncate(descriptor, static_cast<off_t>(synced_bytes())) != 0 || write_all(descriptor, unsynced_) != 0 ||
      ::fsync(descriptor) != 0)
    return false;
  unsynced_.clear();
  sync_failed_ = false;
  return true;
}

Result<void> Journal::sync() {
  mend();
  if (broken_ != nullptr) return fail(path().string(), std::string(broken_) + "; save the case elsewhere");
  if (!unsynced()) return {};
  if (::fsync(file_->descriptor()) == 0) {
    unsynced_.clear();
    return {};
  }
  const int error = errno;
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
