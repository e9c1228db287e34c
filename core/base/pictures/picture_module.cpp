#include "core/base/pictures/picture_module.h"

#ifdef HOMOLOG_OPENIMAGEIO
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#endif

#include "core/base/pictures/picture_readers.h"
#include "core/base/text/text.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

bool is_png_name(const fs::path& path) {
  return lower_case(path.extension().string()) == ".png";
}

Result<Picture> read(const fs::path& path) {
  if (!is_png_name(path)) return fail(path.string(), "is not named as a PNG picture; convert it to one");
  return read_png(path);
}

tl::unexpected<Error> no_kind_of_picture(const fs::path& path) {
  return fail(path.string(), "is no kind of picture that can be written; end its name in .png");
}

#ifdef HOMOLOG_OPENIMAGEIO
/// In memory, since OpenImageIO does not tell of a full disk.
Result<std::vector<unsigned char>> encode_other(const Picture& picture, const fs::path& path) {
  const auto output = OIIO::ImageOutput::create(path.string());
  if (!output || output->supports("ioproxy") == 0) return no_kind_of_picture(path);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput file(bytes);
  OIIO::ImageSpec spec(picture.width, picture.height, 4, OIIO::TypeUInt8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  if (!output->set_ioproxy(&file) || !output->open(path.string(), spec) ||
      !output->write_image(OIIO::TypeUInt8, picture.rgba.data()) || !output->close())
    return fail(path.string(), "cannot be written (" + output->geterror() + "); end its name in .png");
  return bytes;
}
#else
Result<std::vector<unsigned char>> encode_other(const Picture&, const fs::path& path) {
  return no_kind_of_picture(path);
}
#endif

Result<std::vector<unsigned char>> encode(const Picture& picture, const fs::path& path) {
  return is_png_name(path) ? encode_png(picture, path) : encode_other(picture, path);
}

Result<PicturePages> pages(const fs::path& path) {
  return is_png_name(path) ? png_pages(path) : tiff_pages(path);
}

Result<void> read_pages(const fs::path& path, const PicturePages& expected, const PageRoom& room) {
  return is_png_name(path) ? read_png_page(path, expected, room) : read_tiff_pages(path, expected, room);
}

constexpr PictureModule module{read, encode, pages, read_pages, encode_gif, decode_jpeg};

}  // namespace
}  // namespace homolog

extern "C" const homolog::PictureModule* homolog_picture_module() {
  return &homolog::module;
}
