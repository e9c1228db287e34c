#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/numbers/scalar.h"
#include "core/base/pictures/picture.h"
#include "core/base/result.h"

// The border between the program and its picture module, the only part that knows OpenImageIO, libpng, libtiff, giflib
// and GDCM. The module is loaded when first needed.
namespace homolog {

/// One greyscale picture or a file of several pages.
struct PicturePages {
  int width = 0, height = 0, pages = 0;
  Scalar values = Scalar::uint8;  ///< whole numbers of fewer than 8 bits are spread over 0…255
  bool operator==(const PicturePages&) const = default;
};

/// Gives the memory for the next `bytes` bytes, or an error that ends the reading. Readers call it as rows arrive. The
/// rooms of one page lie one behind the other in memory.
using PageRoom = std::function<Result<std::span<std::byte>>(std::size_t bytes)>;

/// How DICOM describes a plane of pixels that is encoded as JPEG, JPEG-LS or JPEG 2000.
struct JpegPlane {
  std::string transfer_syntax;  ///< its UID
  int columns = 0, rows = 0, bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
};

/// The module's functions. All refuse damaged files. A name decides by its ending which reader a file gets, so that no
/// other is tried on what it may hold instead.
struct PictureModule {
  /// PNG.
  Result<Picture> (*read)(const std::filesystem::path& path);
  /// The bytes of a file of this name, in the format of its extension.
  Result<std::vector<unsigned char>> (*encode)(const Picture& picture, const std::filesystem::path& path);
  /// Size and type of the pages of a greyscale PNG or TIFF; fails where they differ or have colours.
  Result<PicturePages> (*pages)(const std::filesystem::path& path);
  /// All pages, each top row first in the type that `pages` gave; room is asked for as rows arrive, so that a file that
  /// claims much and holds little takes little. Fails where they are no longer `expected`.
  Result<void> (*read_pages)(const std::filesystem::path& path, const PicturePages& expected, const PageRoom& room);
  /// The bytes of a GIF that plays [encode_gif in picture_readers.h].
  Result<std::vector<unsigned char>> (*encode_gif)(const std::vector<Picture>& frames, int hundredths,
                                                   const std::filesystem::path& path);
  /// Decodes a grey plane into `out`, which has just its size. False where it does not decode. The decoders print what
  /// they dislike on the standard error.
  bool (*decode_jpeg)(const JpegPlane& plane, std::span<const char> stream, std::span<std::byte> out);
};

/// The loaded module, or why it cannot be loaded.
Result<const PictureModule*> picture_module();

/// The function that the module exports, by this name.
using PictureModuleEntry = const PictureModule* (*)();
constexpr const char* picture_module_entry = "homolog_picture_module";

}  // namespace homolog
