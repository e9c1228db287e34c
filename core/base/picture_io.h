#pragma once

#include <filesystem>

#include "core/base/picture.h"
#include "core/base/result.h"

namespace homolog {

/// PNG (or another format that OpenImageIO writes, by extension), whole or not at all. OpenImageIO is loaded when
/// first needed: its libraries cost 0.2 s and 134 MB.
Result<void> write_picture(const Picture& picture, const std::filesystem::path& path);
/// Reads a PNG. Errors: absent or unreadable, another format, damaged or cut short.
Result<Picture> read_picture(const std::filesystem::path& path);

}  // namespace homolog
