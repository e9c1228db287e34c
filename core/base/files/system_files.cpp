#include "core/base/files/files.h"

#include <fcntl.h>
#include <linux/limits.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <optional>
#include <set>
#include <streambuf>
#include <system_error>
#include <vector>

#include "core/base/files/open_file.h"
#include "core/base/files/system_write.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

// ".homolog-", 16 digits that nobody can guess, ".tmp": shorter than any name the user may choose for the file itself.
constexpr std::string_view temporary_start = ".homolog-", temporary_end = ".tmp";
constexpr std::size_t temporary_digits = 16;
constexpr std::time_t stale_after_seconds = 24 * 60 * 60;

std::string reason(int error) {
  return std::strerror(error);
}

Error cannot_write(const fs::path& path, int error) {
  const char* remedy = error == ENOSPC || error == EDQUOT || error == EFBIG  ? "; free some space and save again"
                       : error == EACCES || error == EROFS || error == EPERM ? "; choose a folder you may write to"
                       : error == ENOENT || error == ENOTDIR ? "; create the folder first or choose another"
                       : error == ENAMETOOLONG               ? "; choose a shorter name"
                                                             : "";
  return {path.string(), "cannot be written (" + reason(error) + ")" + remedy};
}

Error cannot_read(const fs::path& path, int error) {
  if (error == ENOENT || error == ENOTDIR) return {path.string(), "does not exist; check the name"};
  const char* remedy = error == EACCES || error == EPERM ? "; check its permissions" : "; check the name and the disk";
  return {path.string(), "cannot be read (" + reason(error) + ")" + remedy};
}

/// An open file of the system, closed at the end.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return number_; }  // NOLINT(google-explicit-constructor): the system's calls take it
  /// 0 or the errno: some network disks only tell then that they are full.
  int close() {
    const int error = number_ >= 0 && ::close(number_) != 0 ? errno : 0;
    number_ = -1;
    return error;
  }

 private:
  int number_;
};

/// A stream's way into an open file. Keeps the first error, which streams do not tell.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(int descriptor) : descriptor_(descriptor) { empty(); }
  int error() const { return error_; }

 protected:
  int_type overflow(int_type c) override {
    if (sync() != 0) return traits_type::eof();
    return traits_type::eq_int_type(c, traits_type::eof()) ? traits_type::not_eof(c)
                                                           : sputc(traits_type::to_char_type(c));
  }
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    if (count < epptr() - pptr()) return std::streambuf::xsputn(bytes, count);
    return sync() == 0 && put({bytes, static_cast<std::size_t>(count)}) ? count : 0;
  }
  int sync() override {
    const bool written = put({pbase(), static_cast<std::size_t>(pptr() - pbase())});
    empty();
    return written ? 0 : -1;
  }

 private:
  void empty() { setp(buffer_.data(), buffer_.data() + buffer_.size()); }
  bool put(std::string_view bytes) {
    if (error_ == 0) error_ = write_all(descriptor_, bytes);
    return error_ == 0;
  }

  int descriptor_, error_ = 0;
  std::array<char, 1 << 16> buffer_;
};

/// The file that a link leads to, so that it stays one. Errors: it leads to nothing.
Result<fs::path> followed(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::canonical(path, error);
  if (!error) return target;
  const std::string remedy = "; remove the link or choose another name";
  if (error == std::errc::too_many_symbolic_link_levels)
    return fail(path.string(), "is a link that leads back to itself" + remedy);
  if (error != std::errc::no_such_file_or_directory)
    return fail(path.string(), "is a link that cannot be followed (" + error.message() + ")" + remedy);
  return fail(path.string(),
              "is a link to " + excerpt(fs::read_symlink(path, error).string()) + ", which does not exist" + remedy);
}

constexpr const char* access_list_name = "system.posix_acl_access";

/// A file's access list as the system keeps it; empty without one. Nothing where it cannot be read.
std::optional<std::vector<char>> access_list_of(const fs::path& path) {
  std::vector<char> list(XATTR_SIZE_MAX);
  const ssize_t size = ::getxattr(path.c_str(), access_list_name, list.data(), list.size());
  if (size < 0 && errno != ENODATA && errno != ENOTSUP) return {};
  list.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return list;
}

/// Whether its owner meant to keep a file as it is. Root may write everything, so only the rights tell.
Result<void> may_be_replaced(const fs::path& path, const struct stat& file) {
  const int refused = ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0 ? errno : 0;
  if ((file.st_mode & 0222) == 0 || refused == EACCES || refused == EPERM)
    return fail(path.string(), "is write-protected; change its permissions or choose another name");
  if (refused != 0) return fail(cannot_write(path, refused));
  return {};
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Brings a folder's names to the disk; 0, or the errno of a disk that fails. Some file systems cannot do it.
int sync_names(const fs::path& folder) {
  const Descriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file < 0 || ::fsync(file) == 0) return 0;
  return errno == EIO || errno == ENOSPC || errno == EDQUOT ? errno : 0;
}

std::optional<std::string> temporary_name() {
  std::array<unsigned char, temporary_digits / 2> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) return std::nullopt;
  std::string name(temporary_start);
  for (const unsigned char byte : random)
    for (const int digit : {byte >> 4, byte & 15}) name += "0123456789abcdef"[digit];
  return name.append(temporary_end);
}

bool is_temporary_name(std::string_view name) {
  return name.size() == temporary_start.size() + temporary_digits + temporary_end.size() &&
         name.starts_with(temporary_start) && name.ends_with(temporary_end) &&
         name.substr(temporary_start.size(), temporary_digits).find_first_not_of("0123456789abcdef") ==
             std::string_view::npos;
}

/// Whether a file is what a program that was killed left behind: this user's, untouched for a day, and locked by
/// nobody who is still writing it.
bool is_stale(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat now {};
  return file >= 0 && ::fstat(file, &now) == 0 && S_ISREG(now.st_mode) && now.st_uid == ::geteuid() &&
         now.st_nlink == 1 && now.st_mtime < std::time(nullptr) - stale_after_seconds &&
         ::flock(file, LOCK_EX | LOCK_NB) == 0;
}

/// Removes what is stale in a folder, at the first file that this program writes there.
void sweep(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> swept;
  {
    const std::lock_guard lock(mutex);
    if (!swept.insert(folder).second) return;
  }
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (is_temporary_name(entry->path().filename().native()) && is_stale(entry->path()))
      ::unlink(entry->path().c_str());
}

/// A new file beside PATH that no other call knows of, locked while it is written; removed unless it took PATH's place.
class Temporary {
 public:
  /// `replaced`: the file whose place it is to take, where there is one.
  Temporary(const fs::path& path, const struct stat* replaced, Readers readers)
      : path_(make_name(path)), file_(open_new(path_, replaced != nullptr || readers == Readers::user_alone)) {
    error_ = file_ >= 0 ? 0 : errno;
    if (error_ != 0) return;
    ::flock(file_, LOCK_EX | LOCK_NB);
    if (replaced != nullptr) take_rights_of(path, *replaced);
  }
  ~Temporary() {
    if (file_ >= 0) ::unlink(path_.c_str());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  int error() const { return error_; }
  /// Whether the file that is replaced belongs to another user and another group, whom the system does not let this one
  /// be given to. Where the group stays, as in a team's folder, its members share the file whoever wrote it last.
  bool changes_hands() const { return changes_hands_; }
  int descriptor() const { return file_; }
  /// 0 or the errno.
  int replace(const fs::path& path) {
    int error = ::fsync(file_) == 0 || errno == EINVAL ? 0 : errno;  // some file systems cannot sync
    if (error == 0 && ::rename(path_.c_str(), path.c_str()) != 0) error = errno;
    if (error != 0) return error;
    path_.clear();
    // Kept open until here, for its lock.
    return file_.close();
  }

 private:
  static fs::path make_name(const fs::path& path) {
    const auto name = temporary_name();
    return name ? folder_of(path) / *name : fs::path();
  }
  static int open_new(const fs::path& path, bool for_user_alone) {
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, for_user_alone ? 0600 : 0666);
  }
  /// Another one must not get the group's rights if it cannot be kept. Where there is an access list, the bits of
  /// the group are its mask, the most that anybody named in it may do: without the list they would be the group's own.
  void take_rights_of(const fs::path& path, const struct stat& replaced) {
    const mode_t mode = replaced.st_mode & 0777;
    const bool group_stays = ::fchown(file_, static_cast<uid_t>(-1), replaced.st_gid) == 0;
    struct stat own {};
    const bool owner_stays =
        ::fstat(file_, &own) == 0 &&
        (own.st_uid == replaced.st_uid || ::fchown(file_, replaced.st_uid, static_cast<gid_t>(-1)) == 0);
    changes_hands_ = !owner_stays && !group_stays;
    ::fremovexattr(file_, access_list_name);  // the list that it got from its folder
    const auto list = access_list_of(path);
    if (list && list->empty())
      ::fchmod(file_, group_stays ? mode : (mode & 0707) | (mode & 0007) << 3);
    else if (!list || !group_stays || ::fsetxattr(file_, access_list_name, list->data(), list->size(), 0) != 0)
      ::fchmod(file_, mode & 0700);
  }

  fs::path path_;
  Descriptor file_;
  int error_ = 0;
  bool changes_hands_ = false;
};

/// Opens a file for reading, unless it is none. Pipes are not waited for.
Result<int> open_file(const fs::path& path, struct stat& now) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file < 0) return fail(cannot_read(path, errno));
  if (::fstat(file, &now) == 0 && S_ISREG(now.st_mode)) return file;
  ::close(file);
  return fail(not_a_file(path, S_ISDIR(now.st_mode) ? FileStatus::Kind::folder : FileStatus::Kind::other));
}

}  // namespace

Result<void> write_whole_file(const fs::path& asked, const std::function<Result<void>(std::ostream&)>& write,
                              Readers readers) {
  const auto target = followed(asked);
  if (!target) return fail(target.error());
  const fs::path& path = *target;
  struct stat before {};
  const bool replaces = ::stat(path.c_str(), &before) == 0;
  if (replaces && S_ISDIR(before.st_mode)) return fail(path.string(), "is a folder; give a file name");
  if (replaces && !S_ISREG(before.st_mode))
    return fail(path.string(), "is a device or a pipe, which is not replaced; give a file name");
  if (replaces)
    if (auto allowed = may_be_replaced(path, before); !allowed) return allowed;
  sweep(folder_of(path));
  Temporary temporary(path, replaces ? &before : nullptr, readers);
  if (temporary.error() != 0) return fail(cannot_write(path, temporary.error()));
  if (temporary.changes_hands())
    return fail(path.string(), "belongs to another user and to a group that you are not in; choose another name");
  FileBuffer buffer(temporary.descriptor());
  std::ostream out(&buffer);
  auto written = write(out);
  out.flush();
  // What the system says first is the cause of whatever else went wrong.
  if (buffer.error() != 0) return fail(cannot_write(path, buffer.error()));
  if (!written) return written;
  if (!out) return fail(cannot_write(path, EIO));
  if (const int error = temporary.replace(path); error != 0) return fail(cannot_write(path, error));
  if (const int error = sync_names(folder_of(path)); error != 0)
    return fail(path.string(),
                "was written, but the disk does not confirm it (" + reason(error) + "); check the disk and save again");
  return {};
}

Result<void> write_whole_file(const fs::path& path, std::string_view content, Readers readers) {
  return write_whole_file(
      path,
      [content](std::ostream& out) {
        out.write(content.data(), static_cast<std::streamsize>(content.size()));
        return Result<void>();
      },
      readers);
}

Result<std::string> read_whole_file(const fs::path& path, std::uintmax_t limit_bytes) {
  struct stat now {};
  const auto opened = open_file(path, now);
  if (!opened) return fail(opened.error());
  const Descriptor file(*opened);
  const Error too_large{path.string(), "is too large to be a file of this kind"};
  if (static_cast<std::uintmax_t>(now.st_size) > limit_bytes) return fail(too_large);
  std::string bytes;
  bytes.reserve(static_cast<std::size_t>(now.st_size));
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const ssize_t got = ::read(file, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(path.string(), "cannot be read to its end (" + reason(errno) + "); copy it again");
    if (got == 0) return bytes;
    bytes.append(buffer.data(), static_cast<std::size_t>(got));
    if (bytes.size() > limit_bytes) return fail(too_large);
  }
}

Result<std::uintmax_t> size_of_file(const fs::path& path) {
  struct stat now {};
  const auto opened = open_file(path, now);
  if (!opened) return fail(opened.error());
  ::close(*opened);
  return static_cast<std::uintmax_t>(now.st_size);
}

Result<void> check_not_read(const std::vector<fs::path>& to_write, const std::vector<fs::path>& read) {
  std::error_code ignored;
  std::set<fs::path> known;
  for (const fs::path& file : read)
    if (!file.empty()) known.insert(fs::weakly_canonical(file, ignored));
  for (const fs::path& file : to_write)
    if (known.contains(fs::weakly_canonical(file, ignored)))
      return fail(file.string(), "is read here and would be written over; name another folder");
  return {};
}

Result<ResultFolder> ResultFolder::make(const fs::path& folder) {
  ResultFolder made;
  std::error_code error;
  for (fs::path missing = folder; !missing.empty() && !fs::exists(missing, error); missing = missing.parent_path())
    made.made_.push_back(missing);
  if (auto whole = make_folder(folder); !whole) return fail(whole.error());
  return made;
}

ResultFolder::~ResultFolder() {
  for (const fs::path& folder : made_) ::rmdir(folder.c_str());  // which refuses while there is something in it
}

Result<void> make_folder(const fs::path& folder, Readers readers) {
  std::error_code ignored;
  if (folder.empty() || fs::is_directory(folder, ignored)) return {};
  if (folder.native().starts_with(std::string(no_home) + "/."))  // names of programs' own data begin with a dot
    return fail("HOME", "is not set, and the system knows no home of this user, so nothing can be kept there; set it");
  if (const fs::path above = folder.parent_path(); above != folder)
    if (auto made = make_folder(above, readers); !made) return made;
  if (::mkdir(folder.c_str(), readers == Readers::user_alone ? 0700 : 0777) == 0) {
    sync_names(folder_of(folder));  // things kept in it are not lost with its name
    return {};
  }
  const int error = errno;
  if (error == EEXIST && fs::is_directory(folder, ignored)) return {};
  return fail(folder.string(), "cannot be made a folder (" + reason(error) + "); choose another place");
}

fs::path home_folder() {
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') return home;
  std::array<char, 16384> text;
  passwd user{};
  passwd* known = nullptr;
  const bool found = ::getpwuid_r(::geteuid(), &user, text.data(), text.size(), &known) == 0 && known != nullptr;
  return found && known->pw_dir != nullptr && *known->pw_dir != '\0' ? known->pw_dir : no_home;
}

}  // namespace homolog
