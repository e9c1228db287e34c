#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include "core/base/processes/progress.h"
#include "core/base/result.h"

namespace homolog {

/// SHA-256 [FIPS 180-4] of bytes, as 64 digits in lower case. Nobody can make other bytes of the same one.
Result<std::string> sha256_of(std::string_view bytes);

/// The same of a file, or of its first `most_bytes`. A file that is shorter is taken as it is. Errors: the file cannot
/// be read, or is no file (a device, a pipe, a folder); cancelled.
Result<std::string> sha256_of_file(const std::filesystem::path& path, Progress* progress = nullptr,
                                   std::uintmax_t most_bytes = std::numeric_limits<std::uintmax_t>::max());

}  // namespace homolog
