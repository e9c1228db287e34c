#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/base/files/open_file.h"
#include "core/base/files/system_write.h"

namespace homolog {

int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : EIO;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

namespace {

FileStatus in_our_words(const struct stat& file) {
  const auto kind = S_ISREG(file.st_mode)   ? FileStatus::Kind::file
                    : S_ISDIR(file.st_mode) ? FileStatus::Kind::folder
                                            : FileStatus::Kind::other;
  constexpr std::int64_t ns_per_second = 1'000'000'000;
  return {kind, file.st_dev, file.st_ino, static_cast<std::uint64_t>(file.st_size),
          file.st_ctim.tv_sec * ns_per_second + file.st_ctim.tv_nsec};
}

}  // namespace

std::optional<FileStatus> status_of(const std::filesystem::path& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return std::nullopt;
  return in_our_words(file);
}

Error not_a_file(const std::filesystem::path& path, FileStatus::Kind kind) {
  return {path.string(), kind == FileStatus::Kind::folder
                             ? "is a folder, not a file; give the name of a file in it"
                             : "is a device or a pipe, not a file; copy what it gives into a file"};
}

bool is_write_protected(const std::filesystem::path& path) {
  return ::access(path.c_str(), R_OK) == 0 && ::access(path.c_str(), W_OK) != 0;
}

tl::expected<OpenFile, int> OpenFile::open(const std::filesystem::path& path, For what) {
  const int access = what == For::reading ? O_RDONLY : O_RDWR | O_APPEND;
  const int descriptor = ::open(path.c_str(), access | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return tl::unexpected(errno);
  return OpenFile(descriptor);
}

OpenFile::OpenFile(OpenFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::optional<FileStatus> OpenFile::status() const {
  struct stat file {};
  if (::fstat(descriptor_, &file) != 0) return std::nullopt;
  return in_our_words(file);
}

bool OpenFile::is_on_read_only_disk() const {
  struct statvfs disk {};
  return ::fstatvfs(descriptor_, &disk) == 0 && (disk.f_flag & ST_RDONLY) != 0;
}

tl::expected<std::size_t, int> OpenFile::read_at(char* into, std::size_t most, std::uint64_t at) const {
  for (;;) {
    const ssize_t got = ::pread(descriptor_, into, most, static_cast<off_t>(at));
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR) return tl::unexpected(errno);
  }
}

int OpenFile::append(std::string_view bytes) const {
  return write_all(descriptor_, bytes);
}

int OpenFile::cut_to(std::uint64_t bytes) const {
  return ::ftruncate(descriptor_, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
}

int OpenFile::sync() const {
  return ::fsync(descriptor_) == 0 ? 0 : errno;
}

bool OpenFile::lock() const {
  return ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
}

bool OpenFile::is_locked() const {
  if (::flock(descriptor_, LOCK_SH | LOCK_NB) != 0) return true;
  ::flock(descriptor_, LOCK_UN);
  return false;
}

void OpenFile::unlock() const {
  ::flock(descriptor_, LOCK_UN);
}

}  // namespace homolog
