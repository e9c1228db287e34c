#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "core/base/result.h"

namespace homolog {

/// Writes a file so that PATH holds either what it held before or the whole new content: `write` fills a temporary
/// file beside PATH, which is synced and then renamed. Nothing is left behind on failure (full disk, unwritable
/// folder, `write` returning an error). Where PATH is a link, what it leads to is written.
Result<void> write_whole_file(const std::filesystem::path& path,
                              const std::function<Result<void>(std::ostream&)>& write);

/// The same for libraries that insist on writing a file themselves: `write` is given a temporary name in PATH's
/// folder that ends as PATH does (so that a format chosen by extension stays right).
Result<void> write_through_temporary(const std::filesystem::path& path,
                                     const std::function<Result<void>(const std::filesystem::path&)>& write);

/// The bytes of a file, or an error that says why they cannot be read (absent, a folder, unreadable, larger than
/// `limit_bytes`).
Result<std::string> read_whole_file(const std::filesystem::path& path,
                                    std::uintmax_t limit_bytes = std::uintmax_t{1} << 34);

/// The size of a file in bytes. Errors: absent, a folder, a device or a pipe (which may never end), no permission.
Result<std::uintmax_t> size_of_file(const std::filesystem::path& path);

}  // namespace homolog
