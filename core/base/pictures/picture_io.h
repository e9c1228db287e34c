#pragma once

#include <filesystem>
#include <vector>

#include "core/base/pictures/picture.h"
#include "core/base/result.h"

namespace homolog {

/// The file of the picture module, for a program that has none beside itself. Before the first picture.
void use_picture_module(const std::filesystem::path& file);
/// PNG (or, where the picture module is built with OpenImageIO, another format that it writes, by extension), whole or
/// not at all. The module is loaded when first needed: OpenImageIO's libraries cost 0.2 s and 134 MB.
Result<void> write_picture(const Picture& picture, const std::filesystem::path& path);
/// Whether a picture can have this name. Errors: write_picture's for the name.
Result<void> can_write_picture(const std::filesystem::path& path);
/// A GIF that plays its frames for ever, each for that many hundredths of a second, whole or not at all. They have one
/// size, and there is at least one.
Result<void> write_gif(const std::vector<Picture>& frames, int hundredths, const std::filesystem::path& path);
/// Reads a PNG. Errors: absent or unreadable, another format, damaged or cut short.
Result<Picture> read_picture(const std::filesystem::path& path);

}  // namespace homolog
