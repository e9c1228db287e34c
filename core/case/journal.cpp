#include "core/case/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/base/files.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

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

}  // namespace

Result<std::unique_ptr<Journal>> Journal::create(const fs::path& path, std::string_view first_lines) {
  // A case that another program has open must not be replaced under it.
  if (in_use(path)) return fail(open_elsewhere(path));
  const Readers readers = path.parent_path() == unsaved_folder() ? Readers::user_alone : Readers::as_usual;
  auto written = write_whole_file(path, first_lines, readers);
  if (!written) return fail(written.error());
  return open(path);
}

Result<std::unique_ptr<Journal>> Journal::open(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) {
    return fail(path.string(), std::string("cannot be opened for writing (") + std::strerror(errno) +
                                   "); make it writable or save the case elsewhere");
  }
  std::unique_ptr<Journal> journal(new Journal(path, descriptor));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) return fail(open_elsewhere(path));
  return journal;
}

bool Journal::in_use(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // pipes are not waited for
  if (descriptor < 0) return false;
  const bool used = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0;
  ::close(descriptor);
  return used;
}

Result<void> Journal::keep_first(std::uintmax_t keep_bytes) {
  char last = '\n';
  struct stat now {};
  int error = ::fstat(descriptor_, &now) == 0 ? 0 : errno;
  // A whole file is left alone, its time of change too.
  const bool longer = error == 0 && static_cast<std::uintmax_t>(now.st_size) != keep_bytes;
  if (longer) error = ::ftruncate(descriptor_, static_cast<off_t>(keep_bytes)) == 0 ? 0 : errno;
  if (error == 0 && keep_bytes > 0 && ::pread(descriptor_, &last, 1, static_cast<off_t>(keep_bytes) - 1) < 0)
    error = errno;
  const bool open_ended = error == 0 && last != '\n';
  if (open_ended) error = write_all(descriptor_, "\n");
  if (error == 0 && (longer || open_ended) && ::fsync(descriptor_) != 0) error = errno;
  if (error == 0) return {};
  return fail(path_.string(), std::string("cannot be written (") + std::strerror(error) + "); save the case elsewhere");
}

Journal::~Journal() {
  ::close(descriptor_);
}

Result<void> Journal::append(std::string_view line) {
  const off_t before = ::lseek(descriptor_, 0, SEEK_END);
  std::string bytes(line);
  bytes += '\n';
  int error = before < 0 ? errno : write_all(descriptor_, bytes);
  if (error == 0 && ::fsync(descriptor_) != 0) error = errno;
  if (error == 0) return {};
  if (before >= 0 && ::ftruncate(descriptor_, before) == 0) ::fsync(descriptor_);
  return fail(path_.string(), std::string("could not be written (") + std::strerror(error) +
                                  "), so the edit was not made; free some space or save the case elsewhere");
}

fs::path unsaved_folder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0') {
    return fs::path(state) / "homolog";
  }
  return home_folder() / ".local" / "state" / "homolog";
}

}  // namespace homolog
