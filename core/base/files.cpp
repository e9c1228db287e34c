#include "core/base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace homolog {
namespace fs = std::filesystem;

namespace {

std::string reason(int error) {
  return std::strerror(error);
}

Error cannot_write(const fs::path& path, int error) {
  const char* remedy = error == ENOSPC                       ? "; free some space and save again"
                       : error == EACCES || error == EROFS   ? "; choose a folder you may write to"
                       : error == ENOENT || error == ENOTDIR ? "; create the folder first or choose another"
                                                             : "";
  return {path.string(), "cannot be written (" + reason(error) + ")" + remedy};
}

/// Pushes a file's (or folder's) content to the disk; 0 or the errno.
int sync_path(const fs::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) return errno;
  const int error = ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  return error == EINVAL ? 0 : error;  // some file systems cannot sync a folder
}

/// What a link leads to, so that it stays one.
fs::path followed(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::canonical(path, error);
  return error ? path : target;
}

fs::path temporary_beside(const fs::path& path) {
  // The extension stays last and ".gz" keeps its partner, since libraries choose the format by it.
  return path.parent_path() / (".tmp" + std::to_string(::getpid()) + "-" + path.filename().string());
}

}  // namespace

Result<void> write_through_temporary(const fs::path& asked, const std::function<Result<void>(const fs::path&)>& write) {
  const fs::path path = followed(asked);
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return fail(path.string(), "is a folder; give a file name");
  const fs::path temporary = temporary_beside(path);
  {  // ask the system first: libraries seldom say why a file could not be made
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0) return fail(cannot_write(path, errno));
    ::close(fd);
  }
  if (auto written = write(temporary); !written) {
    fs::remove(temporary, ignored);
    Error error = written.error();
    if (error.subject == temporary.string()) error.subject = path.string();
    return fail(std::move(error));
  }
  if (const int error = sync_path(temporary, O_RDONLY); error != 0) {
    fs::remove(temporary, ignored);
    return fail(cannot_write(path, error));
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const int error = errno;
    fs::remove(temporary, ignored);
    return fail(cannot_write(path, error));
  }
  sync_path(path.has_parent_path() ? path.parent_path() : fs::path("."), O_RDONLY | O_DIRECTORY);
  return {};
}

Result<void> write_whole_file(const fs::path& path, const std::function<Result<void>(std::ostream&)>& write) {
  return write_through_temporary(path, [&](const fs::path& temporary) -> Result<void> {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    if (!out) return fail(cannot_write(path, errno));
    if (auto written = write(out); !written) return written;
    errno = 0;
    out.close();
    if (!out) return fail(cannot_write(path, errno != 0 ? errno : ENOSPC));
    return {};
  });
}

Result<std::string> read_whole_file(const fs::path& path, std::uintmax_t limit_bytes) {
  std::error_code error;
  if (fs::is_directory(path, error)) return fail(path.string(), "is a folder, not a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    const bool absent = !fs::exists(path, error);
    return fail(path.string(), absent ? "does not exist; check the name" : "cannot be read; check its permissions");
  }
  std::string bytes;
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error) {
    if (size > limit_bytes) return fail(path.string(), "is too large to be a file of this kind");
    bytes.reserve(size);
  }
  char buffer[1 << 16];
  while (in.read(buffer, sizeof buffer) || in.gcount() > 0) {
    bytes.append(buffer, static_cast<std::size_t>(in.gcount()));
    if (bytes.size() > limit_bytes) return fail(path.string(), "is too large to be a file of this kind");
  }
  if (in.bad()) return fail(path.string(), "cannot be read to its end (disk or network error)");
  return bytes;
}

Result<std::uintmax_t> size_of_file(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file < 0)
    return fail(path.string(), errno == ENOENT ? "does not exist; check the name"
                                               : "cannot be read (" + reason(errno) + "); check its permissions");
  struct stat now {};
  const bool known = ::fstat(file, &now) == 0;
  ::close(file);
  if (known && S_ISREG(now.st_mode)) return static_cast<std::uintmax_t>(now.st_size);
  return fail(path.string(), S_ISDIR(now.st_mode) ? "is a folder, not a file"
                                                  : "is a device or a pipe, not a file; copy what it gives into a file");
}

}  // namespace homolog
