#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "core/base/picture.h"
#include "core/base/result.h"

// The border between the program and its picture module, the only part that knows OpenImageIO. The module is loaded
// when first needed.
namespace homolog {

enum class PictureValues { Uint8, Int8, Uint16, Int16, Uint32, Int32, Float32, Float64 };

/// One greyscale picture or a file of several pages.
struct PicturePages {
  int width = 0, height = 0, pages = 0;
  PictureValues values = PictureValues::Uint8;
  bool operator==(const PicturePages&) const = default;
};

/// The module's functions. All refuse damaged files.
struct PictureModule {
  Result<Picture> (*read)(const std::filesystem::path& path);
  /// In the format of the extension.
  Result<void> (*write)(const Picture& picture, const std::filesystem::path& path);
  /// Size and type of a greyscale file's pages; fails where they differ or have colours.
  Result<PicturePages> (*pages)(const std::filesystem::path& path);
  /// One page, top row first, in the file's own type; `out` has its exact size.
  Result<void> (*read_page)(const std::filesystem::path& path, int page, std::span<std::byte> out);
};

/// The loaded module, or why it cannot be loaded.
Result<const PictureModule*> picture_module();

/// What the module exports, by this name.
using PictureModuleEntry = const PictureModule* (*)();
constexpr const char* picture_module_entry = "homolog_picture_module";

}  // namespace homolog
