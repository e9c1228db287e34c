#pragma once

#include "core/base/picture_module.h"

// Within the picture module: the functions of PictureModule for one format each.
namespace homolog {

Result<Picture> read_png(const std::filesystem::path& path);
Result<PicturePages> png_pages(const std::filesystem::path& path);
Result<void> read_png_page(const std::filesystem::path& path, const PicturePages& expected, const PageRoom& room);

/// The bytes of a PNG file. Errors: a size that PNG cannot hold; no memory is left.
Result<std::vector<unsigned char>> encode_png(const Picture& picture, const std::filesystem::path& path);

Result<PicturePages> tiff_pages(const std::filesystem::path& path);
Result<void> read_tiff_pages(const std::filesystem::path& path, const PicturePages& expected, const PageRoom& room);

}  // namespace homolog
