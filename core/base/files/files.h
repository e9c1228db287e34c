#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// Who may read a file that is made anew: everybody whom the user's settings allow, or the user alone.
enum class Readers { as_usual, user_alone };

/// The one way in which the program writes files. PATH holds either what it held before or the whole new content:
/// `write` fills a temporary file that belongs to this call alone and lies beside PATH; it is checked, synced and
/// renamed. Nothing is left behind on failure (full disk, unwritable folder, `write` returning an error).
///
/// A file that is replaced hands on its rights, its access list, its group and its owner, so that a private one stays
/// private. In a team's folder the system may let it keep its group but not its owner: then it belongs to whoever wrote
/// it last. `readers` is for new files. If PATH is a link, the file that it leads to is written.
///
/// Errors: PATH is a folder, a device or a pipe. It is write-protected (for root too, where nobody has the right to
/// write). It is a link that leads nowhere. It is the file of another user and another group, and the system lets the
/// new file be given to neither. The system refuses. A disk that fails when the name is to be kept is an error too,
/// though the file is whole then.
Result<void> write_whole_file(const std::filesystem::path& path,
                              const std::function<Result<void>(std::ostream&)>& write,
                              Readers readers = Readers::as_usual);
/// The same for content that is there already.
Result<void> write_whole_file(const std::filesystem::path& path, std::string_view content,
                              Readers readers = Readers::as_usual);

/// The bytes of a file, or an error that says why they cannot be read: absent, a folder, a device or a pipe (which may
/// never end), no permission, larger than `limit_bytes`.
Result<std::string> read_whole_file(const std::filesystem::path& path,
                                    std::uintmax_t limit_bytes = std::uintmax_t{1} << 34);

/// The size of a file in bytes. Errors: those of read_whole_file.
Result<std::uintmax_t> size_of_file(const std::filesystem::path& path);

/// A folder for the results of one run. Those folders that it made and that are still empty at its end are removed
/// again, so that a run that fails leaves none.
class ResultFolder {
 public:
  /// Makes the folder where there is none, and those above it. Errors: the system refuses.
  static Result<ResultFolder> make(const std::filesystem::path& folder);
  ~ResultFolder();
  ResultFolder(ResultFolder&&) = default;
  ResultFolder& operator=(ResultFolder&&) = delete;

 private:
  ResultFolder() = default;
  std::vector<std::filesystem::path> made_;  ///< the deepest first
};

/// Errors: one of the files to write is one that was read, which would be lost. Neither needs to exist.
Result<void> check_not_read(const std::vector<std::filesystem::path>& to_write,
                            const std::vector<std::filesystem::path>& read);

/// Makes a folder where there is none, and those above it, so that no power cut takes them with what they hold.
/// `readers`: who may enter the new ones. Errors: the system refuses.
Result<void> make_folder(const std::filesystem::path& folder, Readers readers = Readers::as_usual);

/// Below it nobody can make anything.
constexpr const char* no_home = "/dev/null";
/// The user's home: $HOME, else what the system knows, else no_home: make_folder() says then that HOME is not set.
std::filesystem::path home_folder();

}  // namespace homolog
