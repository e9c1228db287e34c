#include <png.h>

#include <csetjmp>
#include <exception>

#include "core/base/pictures/picture_readers.h"

// PNG through libpng, in memory, with its messages kept instead of printed.
namespace homolog {

namespace {

/// Errors of libpng come back by a jump to where it was last set, so that nothing with a destructor may lie between.
class PngBytes {
 public:
  PngBytes() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngBytes() { png_destroy_write_struct(&png_, &info_); }
  PngBytes(const PngBytes&) = delete;
  PngBytes& operator=(const PngBytes&) = delete;

  bool write(const Picture& picture) {
    if (info_ == nullptr || setjmp(jump_) != 0) return false;
    png_set_write_fn(png_, this, append, nullptr);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(picture.width), static_cast<png_uint_32>(picture.height), 8,
                 PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
    png_write_info(png_, info_);
    const std::size_t row_bytes = 4 * static_cast<std::size_t>(picture.width);
    for (int r = 0; r < picture.height; ++r)
      png_write_row(png_, picture.rgba.data() + static_cast<std::size_t>(r) * row_bytes);
    png_write_end(png_, info_);
    return true;
  }

  std::vector<unsigned char> bytes;
  std::string reason;

 private:
  [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
    auto* self = static_cast<PngBytes*>(png_get_error_ptr(png));
    self->reason = message;
    std::longjmp(self->jump_, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}

  static void append(png_structp png, png_bytep data, std::size_t size) {
    bool held = true;
    try {
      auto& bytes = static_cast<PngBytes*>(png_get_io_ptr(png))->bytes;
      bytes.insert(bytes.end(), data, data + size);
    } catch (const std::exception&) {
      held = false;
    }
    if (!held) png_error(png, "memory ran out");
  }

  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::jmp_buf jump_;
};

}  // namespace

Result<std::vector<unsigned char>> encode_png(const Picture& picture, const std::filesystem::path& path) {
  PngBytes png;
  if (!png.write(picture))
    return fail(path.string(), "cannot be written (" + png.reason + "); make the picture smaller");
  return std::move(png.bytes);
}

}  // namespace homolog
