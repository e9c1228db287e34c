#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <limits>

#include "core/base/pictures/picture_readers.h"

// PNG through libpng, with its messages kept instead of printed. It checks every checksum up to the end of the file.
namespace homolog {
namespace fs = std::filesystem;

namespace {

tl::unexpected<Error> damaged_png(const fs::path& path, const std::string& reason) {
  return fail(path.string(), "is no PNG picture, or is damaged" + (reason.empty() ? "" : " (" + reason + ")") +
                                 "; check what it is and copy it again");
}

/// An open file. Errors of libpng come back by a jump to where jump() was last set, so that nothing with a destructor
/// may lie between.
class PngFile {
 public:
  explicit PngFile(const fs::path& path) : path_(path), file_(std::fopen(path.c_str(), "rb")) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngFile() {
    png_destroy_read_struct(&png_, &info_, nullptr);
    if (file_ != nullptr) std::fclose(file_);
  }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  /// Reads all that stands before the pixels.
  Result<void> read_header() {
    if (file_ == nullptr || info_ == nullptr) return damaged_png(path_, "it cannot be opened");
    if (!header_read()) return damaged_png(path_, reason_);
    std::error_code error;
    const auto size = static_cast<double>(fs::file_size(path_, error));
    constexpr double best_ratio = 1032;  // Deflate's, which is all that PNG packs by (zlib's technical details)
    const double bytes = static_cast<double>(png_get_rowbytes(png_, info_)) * png_get_image_height(png_, info_);
    constexpr png_uint_32 most = std::numeric_limits<int>::max();
    if (error || bytes > best_ratio * size || png_get_image_width(png_, info_) > most ||
        png_get_image_height(png_, info_) > most)
      return damaged_png(path_, "it is far too small for its size in pixels");
    // Interlaced rows are there only when all of them are: memory is taken before anything has arrived.
    constexpr double most_at_once = 64 << 20;
    if (bytes > most_at_once && png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE)
      return fail(path_.string(), "is interlaced and too large for that; save it without interlacing");
    return {};
  }
  /// Reads the pixels as `prepare` asked for them, and the rest of the file.
  Result<void> read_pixels(const PageRoom& room) {
    const std::size_t height = png_get_image_height(png_, info_), row_bytes = png_get_rowbytes(png_, info_);
    constexpr std::size_t band_bytes = std::size_t{4} << 20;
    const bool whole = png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE;
    const std::size_t band = whole ? height : std::clamp<std::size_t>(band_bytes / row_bytes, 1, height);
    std::vector<png_bytep> rows(band);
    for (std::size_t y = 0; y < height; y += band) {
      const std::size_t count = std::min(band, height - y);
      const auto out = room(count * row_bytes);
      if (!out) return fail(out.error());
      if (out->size() != count * row_bytes) return damaged_png(path_, "its size changed while it was read");
      for (std::size_t r = 0; r < count; ++r) rows[r] = reinterpret_cast<png_bytep>(out->data() + r * row_bytes);
      if (!rows_read(rows.data(), count, whole)) return damaged_png(path_, reason_);
    }
    if (!end_read()) return damaged_png(path_, reason_);
    return {};
  }
  /// Asks libpng for RGBA of 8 bits, or for the greys as they are (fewer than 8 bits spread over 8).
  bool prepare(bool rgba) {
    if (setjmp(jump_) != 0) return false;
    if (rgba) {
      png_set_expand(png_);
      png_set_scale_16(png_);
      png_set_gray_to_rgb(png_);
      png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    } else {
      png_set_expand_gray_1_2_4_to_8(png_);
      png_set_strip_alpha(png_);
      if (std::endian::native == std::endian::little) png_set_swap(png_);
    }
    if (png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE) png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }

  int width() const { return static_cast<int>(png_get_image_width(png_, info_)); }
  int height() const { return static_cast<int>(png_get_image_height(png_, info_)); }
  bool coloured() const { return (png_get_color_type(png_, info_) & PNG_COLOR_MASK_COLOR) != 0; }
  int bits() const { return png_get_bit_depth(png_, info_); }
  const std::string& reason() const { return reason_; }

 private:
  [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
    auto* self = static_cast<PngFile*>(png_get_error_ptr(png));
    self->reason_ = message;
    std::longjmp(self->jump_, 1);
  }
  /// Libpng warns of what does not touch the pixels (colour profiles, for instance).
  static void on_warning(png_structp, png_const_charp) {}

  bool header_read() {
    if (setjmp(jump_) != 0) return false;
    png_init_io(png_, file_);
    png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_read_info(png_, info_);
    return true;
  }
  bool rows_read(png_bytepp rows, std::size_t count, bool whole) {
    if (setjmp(jump_) != 0) return false;
    if (whole)
      png_read_image(png_, rows);
    else
      png_read_rows(png_, rows, nullptr, static_cast<png_uint_32>(count));
    return true;
  }
  bool end_read() {
    if (setjmp(jump_) != 0) return false;
    png_read_end(png_, nullptr);
    return true;
  }

  fs::path path_;
  std::FILE* file_ = nullptr;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::jmp_buf jump_;
  std::string reason_;
};

Result<PicturePages> grey_page(PngFile& file, const fs::path& path) {
  if (auto header = file.read_header(); !header) return fail(header.error());
  if (file.coloured()) return fail(path.string(), "has colours; save it as a greyscale picture");
  return PicturePages{file.width(), file.height(), 1, file.bits() == 16 ? Scalar::uint16 : Scalar::uint8};
}

}  // namespace

Result<Picture> read_png(const fs::path& path) {
  PngFile file(path);
  if (auto header = file.read_header(); !header) return fail(header.error());
  if (!file.prepare(true)) return damaged_png(path, file.reason());
  Picture picture{file.width(), file.height(), {}};
  picture.rgba.reserve(4 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  const PageRoom room = [&](std::size_t bytes) -> Result<std::span<std::byte>> {
    picture.rgba.resize(picture.rgba.size() + bytes);
    return std::as_writable_bytes(std::span(picture.rgba)).last(bytes);
  };
  if (auto read = file.read_pixels(room); !read) return fail(read.error());
  return picture;
}

Result<PicturePages> png_pages(const fs::path& path) {
  PngFile file(path);
  return grey_page(file, path);
}

Result<void> read_png_page(const fs::path& path, const PicturePages& expected, const PageRoom& room) {
  PngFile file(path);
  const auto page = grey_page(file, path);
  if (!page) return fail(page.error());
  if (*page != expected) return damaged_png(path, "it changed while it was read");
  if (!file.prepare(false)) return damaged_png(path, file.reason());
  return file.read_pixels(room);
}

}  // namespace homolog
