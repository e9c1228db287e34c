#pragma once

#include "core/base/pictures/picture_module.h"

// Within the picture module: the functions of PictureModule for one format each.
namespace homolog {

Result<Picture> read_png(const std::filesystem::path& path);
Result<PicturePages> png_pages(const std::filesystem::path& path);
Result<void> read_png_page(const std::filesystem::path& path, const PicturePages& expected, const PageRoom& room);

/// The bytes of a PNG file. Errors: a size that PNG cannot hold; no memory is left.
Result<std::vector<unsigned char>> encode_png(const Picture& picture, const std::filesystem::path& path);

/// The bytes of a GIF file that plays its frames for ever, each for that many hundredths of a second, with one palette.
/// Frames have one size, and there is at least one. Errors: a size that GIF cannot hold; no memory is left.
Result<std::vector<unsigned char>> encode_gif(const std::vector<Picture>& frames, int hundredths,
                                              const std::filesystem::path& path);

Result<PicturePages> tiff_pages(const std::filesystem::path& path);
Result<void> read_tiff_pages(const std::filesystem::path& path, const PicturePages& expected, const PageRoom& room);

bool decode_jpeg(const JpegPlane& plane, std::span<const char> stream, std::span<std::byte> out);

}  // namespace homolog
