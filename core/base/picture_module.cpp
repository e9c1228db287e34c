#include "core/base/picture_module.h"

#include <OpenImageIO/imageio.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <optional>

namespace homolog {
namespace fs = std::filesystem;
namespace oiio = OIIO;

namespace {

tl::unexpected<Error> damaged(const fs::path& path, const std::string& reason) {
  return fail(path.string(), "is no picture that can be read, or is damaged" +
                                 (reason.empty() ? "" : " (" + reason.substr(0, reason.find('\n')) + ")") +
                                 "; check what it is and copy it again");
}

/// Whether a PNG's chunks are whole up to its end [PNG, §5.3]. Asked first, since libpng prints what it dislikes.
bool png_is_whole(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string chunk(8, '\0');
  if (!in.read(chunk.data(), 8) || chunk != "\x89PNG\r\n\x1a\n") return false;
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  const auto big_endian = [](const char* bytes) {
    std::uint32_t value = 0;
    for (int b = 0; b < 4; ++b) value = value << 8 | static_cast<unsigned char>(bytes[b]);
    return value;
  };
  char length[4], checksum[4];
  while (in.read(length, 4)) {
    if (error || big_endian(length) > size) return false;
    chunk.resize(4 + big_endian(length));
    if (!in.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || !in.read(checksum, 4)) return false;
    const auto* bytes = reinterpret_cast<const Bytef*>(chunk.data());
    if (crc32_z(0, bytes, chunk.size()) != big_endian(checksum)) return false;
    if (chunk.starts_with("IEND")) return true;
  }
  return false;
}

Result<std::unique_ptr<oiio::ImageInput>> open_picture(const fs::path& path) {
  if (path.extension() == ".png" && !png_is_whole(path)) return damaged(path, "");
  oiio::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  auto input = oiio::ImageInput::open(path.string(), &as_stored);
  if (!input) return damaged(path, oiio::geterror());
  return input;
}

/// A header's claim, before memory is taken for it: no picture format packs more than Deflate does.
bool credible(const fs::path& path, const oiio::ImageSpec& spec) {
  std::error_code error;
  const auto size = static_cast<double>(fs::file_size(path, error));
  return !error && spec.width > 0 && spec.height > 0 && static_cast<double>(spec.image_bytes(true)) <= 1100 * size;
}

Result<Picture> read(const fs::path& path) {
  auto input = open_picture(path);
  if (!input) return fail(input.error());
  const oiio::ImageSpec& spec = (*input)->spec();
  if (!credible(path, spec)) return damaged(path, "");
  Picture picture{spec.width, spec.height, {}};
  const auto pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  const auto channels = static_cast<std::size_t>(std::clamp(spec.nchannels, 1, 4));
  std::vector<std::uint8_t> values(pixels * channels);
  if (!(*input)->read_image(0, 0, 0, static_cast<int>(channels), oiio::TypeUInt8, values.data()))
    return damaged(path, (*input)->geterror());
  picture.rgba.resize(4 * pixels);
  const bool grey = channels < 3, alpha = channels == 2 || channels == 4;
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::uint8_t* from = values.data() + channels * p;
    std::uint8_t* to = picture.rgba.data() + 4 * p;
    for (std::size_t c = 0; c < 3; ++c) to[c] = from[grey ? 0 : c];
    to[3] = alpha ? from[channels - 1] : 255;
  }
  return picture;
}

Result<void> write(const Picture& picture, const fs::path& path) {
  const auto output = oiio::ImageOutput::create(path.string());
  if (!output) return fail(path.string(), "is no kind of picture that can be written; end its name in .png");
  oiio::ImageSpec spec(picture.width, picture.height, 4, oiio::TypeUInt8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  if (!output->open(path.string(), spec) || !output->write_image(oiio::TypeUInt8, picture.rgba.data()) ||
      !output->close())
    return fail(path.string(), "cannot be written (" + output->geterror() + ")");
  return {};
}

std::optional<PictureValues> values_of(const oiio::TypeDesc& type) {
  switch (type.basetype) {
    case oiio::TypeDesc::UINT8:
      return PictureValues::Uint8;
    case oiio::TypeDesc::INT8:
      return PictureValues::Int8;
    case oiio::TypeDesc::UINT16:
      return PictureValues::Uint16;
    case oiio::TypeDesc::INT16:
      return PictureValues::Int16;
    case oiio::TypeDesc::UINT32:
      return PictureValues::Uint32;
    case oiio::TypeDesc::INT32:
      return PictureValues::Int32;
    case oiio::TypeDesc::FLOAT:
      return PictureValues::Float32;
    case oiio::TypeDesc::DOUBLE:
      return PictureValues::Float64;
    default:
      return {};
  }
}

Result<PicturePages> pages(const fs::path& path) {
  auto input = open_picture(path);
  if (!input) return fail(input.error());
  std::optional<PicturePages> result;
  for (int page = 0; (*input)->seek_subimage(page, 0); ++page) {
    const oiio::ImageSpec spec = (*input)->spec();
    const bool with_alpha = spec.nchannels == 2 && spec.alpha_channel == 1;
    if (spec.nchannels != 1 && !with_alpha) return fail(path.string(), "has colours; save it as a greyscale picture");
    const auto values = values_of(spec.format);
    if (!values || !credible(path, spec)) return damaged(path, "");
    const PicturePages this_page{spec.width, spec.height, 1, *values};
    if (!result) {
      result = this_page;
      continue;
    }
    if (this_page != PicturePages{result->width, result->height, 1, result->values})
      return fail(path.string(), "has pages of different sizes or types; save those of one stack");
    ++result->pages;
  }
  if (!result) return damaged(path, (*input)->geterror());
  return *result;
}

Result<void> read_page(const fs::path& path, int page, std::span<std::byte> out) {
  auto input = open_picture(path);
  if (!input) return fail(input.error());
  const oiio::ImageSpec spec = (*input)->spec(page, 0);
  const auto size = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) * spec.format.size();
  if (size != out.size()) return damaged(path, "its size changed while it was read");
  if (!(*input)->read_image(page, 0, 0, 1, spec.format, out.data())) return damaged(path, (*input)->geterror());
  return {};
}

constexpr PictureModule module{read, write, pages, read_page};

}  // namespace
}  // namespace homolog

extern "C" const homolog::PictureModule* homolog_picture_module() {
  return &homolog::module;
}
