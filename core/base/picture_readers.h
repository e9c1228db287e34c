#pragma once

#include "core/base/picture_module.h"

// Within the picture module: the readers behind PictureModule, whose functions they are for one format each.
namespace homolog {

Result<Picture> read_png(const std::filesystem::path& path);
Result<PicturePages> png_pages(const std::filesystem::path& path);
Result<void> read_png_page(const std::filesystem::path& path, const PicturePages& expected, const PageRoom& room);

Result<PicturePages> tiff_pages(const std::filesystem::path& path);
Result<void> read_tiff_pages(const std::filesystem::path& path, const PicturePages& expected, const PageRoom& room);

}  // namespace homolog
