#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "core/base/pictures/picture_readers.h"
#include "core/base/pictures/tiff_rows.h"

// TIFF through libtiff, page by page and strip by strip, since what it finds wrong has to be asked for: it fills what a
// file lacks with zeros, and takes a page that cannot be reached for the end.
namespace homolog {
namespace fs = std::filesystem;

namespace {

tl::unexpected<Error> damaged_tiff(const fs::path& path, const std::string& reason) {
  return fail(path.string(), "is no TIFF picture, or is damaged" + (reason.empty() ? "" : " (" + reason + ")") +
                                 "; check what it is and copy it again");
}

tl::unexpected<Error> cut_short(const fs::path& path, int page) {
  return fail(path.string(), "is cut short or damaged: pixels of page " + std::to_string(page) +
                                 " lie outside of the file; copy it again");
}

tl::unexpected<Error> unreadable_kind(const fs::path& path, const std::string& what) {
  return fail(path.string(), what + ", which cannot be read; save it as a plain greyscale picture");
}

/// The words of libtiff on one file, kept instead of printed.
struct Messages {
  std::string error;      ///< the first one
  bool decoding = false;  ///< a warning counts as an error: pixels were made up

  static std::string text_of(const char* format, va_list arguments) {
    char text[300];
    std::vsnprintf(text, sizeof text, format, arguments);
    return text;
  }
  static int on_error(TIFF*, void* self, const char*, const char* format, va_list arguments) {
    auto& error = static_cast<Messages*>(self)->error;
    if (error.empty()) error = text_of(format, arguments);
    return 1;  // nobody else need hear of it
  }
  static int on_warning(TIFF* tiff, void* self, const char* where, const char* format, va_list arguments) {
    // Codes of a byte order that was common once decode as well as others.
    const bool harmless = std::string_view(format).starts_with("Old-style LZW codes");
    if (static_cast<Messages*>(self)->decoding && !harmless) on_error(tiff, self, where, format, arguments);
    return 1;
  }
};

struct TiffCloser {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};

/// One page's kind of pixels, and how they are stored.
struct PageKind {
  PicturePages pages{0, 0, 1, Scalar::uint8};
  TiffRow row;            ///< a row of as many pixels as the page is wide
  int orientation = 1;    ///< 1…4 [TIFF 6.0, "Orientation"]
  bool separate = false;  ///< samples lie in planes of their own; the first plane is read
};

template <class T>
T field(TIFF* tiff, std::uint32_t tag, T otherwise) {
  T value = 0;
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
}

std::optional<Scalar> values_of(int bits, int format) {
  if (format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID) {
    if (bits == 1 || bits == 2 || bits == 4 || bits == 8) return Scalar::uint8;
    if (bits == 10 || bits == 12 || bits == 14 || bits == 16) return Scalar::uint16;
    if (bits == 32) return Scalar::uint32;
  } else if (format == SAMPLEFORMAT_INT) {
    if (bits == 8) return Scalar::int8;
    if (bits == 16) return Scalar::int16;
    if (bits == 32) return Scalar::int32;
  } else if (format == SAMPLEFORMAT_IEEEFP) {
    if (bits == 32) return Scalar::float32;
    if (bits == 64) return Scalar::float64;
  }
  return {};
}

/// Whether a second sample is how opaque a pixel is, so that the first is its grey.
bool second_is_alpha(TIFF* tiff) {
  std::uint16_t count = 0;
  const std::uint16_t* kinds = nullptr;
  return TIFFGetField(tiff, TIFFTAG_EXTRASAMPLES, &count, &kinds) == 1 && count == 1 &&
         (kinds[0] == EXTRASAMPLE_ASSOCALPHA || kinds[0] == EXTRASAMPLE_UNASSALPHA);
}

Result<PageKind> kind_of_page(TIFF* tiff, const fs::path& path) {
  const auto width = field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0),
             height = field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  const int samples = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1),
            bits = field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1),
            format = field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT),
            compression = field<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE),
            planes = field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  std::uint16_t photometric = samples < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
  constexpr std::uint32_t most = std::numeric_limits<int>::max();
  if (width < 1 || height < 1 || width > most || height > most) return damaged_tiff(path, "it has no size");
  const bool grey = photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE;
  if (!grey || samples > 2 || (samples == 2 && !second_is_alpha(tiff)))
    return fail(path.string(), "has colours or several values for each pixel; save it as a greyscale picture");
  if (field<std::uint32_t>(tiff, TIFFTAG_IMAGEDEPTH, 1) > 1)
    return unreadable_kind(path, "has pages of several layers");
  const auto values = values_of(bits, format);
  if (!values) return unreadable_kind(path, "stores its pixels in " + std::to_string(bits) + " bits of another kind");
  if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(compression)) != 1)
    return unreadable_kind(path, "is compressed by method " + std::to_string(compression));
  PageKind kind;
  kind.pages = {static_cast<int>(width), static_cast<int>(height), 1, *values};
  kind.separate = planes == PLANARCONFIG_SEPARATE && samples > 1;
  kind.row = {width, bits, kind.separate ? 1 : samples, photometric == PHOTOMETRIC_MINISWHITE, *values};
  kind.orientation = field<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  if (kind.orientation > ORIENTATION_BOTLEFT) return unreadable_kind(path, "has its rows stored as columns");
  return kind;
}

/// How many bytes a method can make of the `bytes` bytes of a piece. Without a known bound on their ratio, more than 64
/// MB are not believed: memory is taken for the whole piece, and fax decoders make something of any bytes.
double most_decoded(int compression, double bytes) {
  constexpr double most_at_once = 64 << 20;
  switch (compression) {
    case COMPRESSION_NONE:
      return bytes;
    case COMPRESSION_PACKBITS:
      return 64 * bytes;
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_DEFLATE:
      return 1032 * bytes;
    case COMPRESSION_LZW:
      return 4096 * bytes;  // one code of at least nine bits names at most that many
    default:
      return std::min(1e5 * bytes, most_at_once);
  }
}

/// A number behind "NAME=" in ImageJ's description of a stack; 1 where it is not given.
int imagej_number(std::string_view description, std::string_view name) {
  const auto at = description.find("\n" + std::string(name) + "=");
  int number = 1;
  if (at != std::string_view::npos) std::sscanf(description.data() + at + name.size() + 2, "%d", &number);
  return number;
}

class TiffFile {
 public:
  explicit TiffFile(const fs::path& path) : path_(path) {
    std::error_code error;
    const auto size = fs::file_size(path, error);
    size_ = error ? 0 : size;
  }

  /// Goes to the first page.
  Result<void> open() {
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, Messages::on_error, &messages_);
    TIFFOpenOptionsSetWarningHandlerExtR(options, Messages::on_warning, &messages_);
    // For tables and strips, all of which lie in the file; a page's table may have grown by what it leaves out.
    constexpr std::uintmax_t table = std::uintmax_t{16} << 20;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, static_cast<tmsize_t>(2 * size_ + table));
    tiff_.reset(TIFFOpenExt(path_.c_str(), "rm", options));  // "m": not mapped, which a file cut meanwhile would crash
    TIFFOpenOptionsFree(options);
    if (!tiff_) return damaged_tiff(path_, messages_.error);
    return {};
  }
  /// Goes to the next page; false behind the last one, which says itself that it is.
  Result<bool> next_page() {
    if (TIFFLastDirectory(tiff_.get()) != 0) return false;
    ++page_;
    if (TIFFReadDirectory(tiff_.get()) == 1) return true;
    return fail(path_.string(), "is cut short or damaged: page " + std::to_string(page_) +
                                    ", which the one before points to, cannot be read; copy it again");
  }
  Result<PageKind> page_kind() { return kind_of_page(tiff_.get(), path_); }
  Result<void> check_pixels(const PageKind& kind);
  Result<void> check_description(int pages);
  Result<void> read_page(const PageKind& kind, const PageRoom& room);

 private:
  bool tiled() const { return TIFFIsTiled(tiff_.get()) != 0; }
  /// Pixels of a piece (a strip or tile), and how many pieces the plane that is read has.
  std::uint32_t piece_width(const PageKind& kind) const {
    return tiled() ? field<std::uint32_t>(tiff_.get(), TIFFTAG_TILEWIDTH, 0)
                   : static_cast<std::uint32_t>(kind.pages.width);
  }
  std::uint32_t piece_height(const PageKind& kind) const {
    const auto height = static_cast<std::uint32_t>(kind.pages.height);
    return tiled() ? field<std::uint32_t>(tiff_.get(), TIFFTAG_TILELENGTH, 0)
                   : std::min(field<std::uint32_t>(tiff_.get(), TIFFTAG_ROWSPERSTRIP, height), height);
  }
  tl::unexpected<Error> undecoded() const {
    return fail(path_.string(), "is damaged: pixels of page " + std::to_string(page_) + " do not decode" +
                                    (messages_.error.empty() ? "" : " (" + messages_.error + ")") + "; copy it again");
  }

  fs::path path_;
  std::uintmax_t size_ = 0, used_ = 0;
  int page_ = 1;
  Messages messages_;
  std::unique_ptr<TIFF, TiffCloser> tiff_;
};

/// Every piece lies within the file and is large enough for what it should hold; no two share their bytes, so that a
/// small file cannot claim the same piece thousands of times.
Result<void> TiffFile::check_pixels(const PageKind& kind) {
  const int compression = field<std::uint16_t>(tiff_.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  const std::uint64_t width = piece_width(kind), height = piece_height(kind);
  if (width < 1 || height < 1) return damaged_tiff(path_, "its pieces have no size");
  const std::uint64_t across = (static_cast<std::uint64_t>(kind.pages.width) + width - 1) / width,
                      down = (static_cast<std::uint64_t>(kind.pages.height) + height - 1) / height;
  const std::uint64_t pieces = tiled() ? TIFFNumberOfTiles(tiff_.get()) : TIFFNumberOfStrips(tiff_.get());
  if (pieces < across * down) return damaged_tiff(path_, "pieces of its pages are missing");
  TiffRow row = kind.row;
  row.pixels = width;
  const double row_bytes = static_cast<double>(stored_bytes(row));
  for (std::uint64_t p = 0; p < across * down; ++p) {
    const auto piece = static_cast<std::uint32_t>(p);
    const std::uint64_t begin = TIFFGetStrileOffset(tiff_.get(), piece),
                        bytes = TIFFGetStrileByteCount(tiff_.get(), piece);
    if (begin == 0 || bytes == 0 || begin > size_ || bytes > size_ - begin) return cut_short(path_, page_);
    const std::uint64_t rows =
        tiled() ? height : std::min(height, static_cast<std::uint64_t>(kind.pages.height) - p * height);
    if (row_bytes * static_cast<double>(rows) > most_decoded(compression, static_cast<double>(bytes)))
      return cut_short(path_, page_);
    used_ += bytes;
  }
  if (used_ > size_) return damaged_tiff(path_, "its pages share their pixels");
  return {};
}

/// ImageJ writes what does not fit into pages behind the first one, and says so in a description alone.
Result<void> TiffFile::check_description(int pages) {
  const char* text = nullptr;
  if (TIFFGetField(tiff_.get(), TIFFTAG_IMAGEDESCRIPTION, &text) != 1 || text == nullptr) return {};
  const std::string_view description(text);
  if (!description.starts_with("ImageJ=")) return {};
  const int images = imagej_number(description, "images"), slices = imagej_number(description, "slices");
  if (imagej_number(description, "channels") > 1 || (slices > 1 && imagej_number(description, "frames") > 1))
    return fail(path_.string(), "holds several channels or times; save one of them as a stack");
  if (images > pages)
    return fail(path_.string(), "holds " + std::to_string(images) + " slices of which it lists only " +
                                    std::to_string(pages) + "; save it from ImageJ as NRRD or as single pictures");
  return {};
}

/// Turns a page whose first row or column is not the top or left one.
void turn_page(const PageKind& kind, std::span<std::byte> page) {
  const auto height = static_cast<std::size_t>(kind.pages.height), row_bytes = page.size() / height;
  const auto pixel_bytes = row_bytes / static_cast<std::size_t>(kind.pages.width);
  const auto row = [&](std::size_t r) { return page.subspan(r * row_bytes, row_bytes); };
  if (kind.orientation == ORIENTATION_BOTLEFT || kind.orientation == ORIENTATION_BOTRIGHT)
    for (std::size_t r = 0; r < height / 2; ++r)
      std::swap_ranges(row(r).begin(), row(r).end(), row(height - 1 - r).begin());
  if (kind.orientation == ORIENTATION_TOPRIGHT || kind.orientation == ORIENTATION_BOTRIGHT)
    for (std::size_t r = 0; r < height; ++r) {
      std::reverse(row(r).begin(), row(r).end());
      for (std::size_t p = 0; p < row_bytes; p += pixel_bytes)
        std::reverse(row(r).subspan(p, pixel_bytes).begin(), row(r).subspan(p, pixel_bytes).end());
    }
}

Result<void> TiffFile::read_page(const PageKind& kind, const PageRoom& room) {
  const std::size_t width = kind.row.pixels, height = static_cast<std::size_t>(kind.pages.height);
  const std::size_t across = piece_width(kind), down = piece_height(kind), value_bytes = size_of(kind.pages.values);
  TiffRow whole = kind.row;
  whole.pixels = across;
  const std::size_t row_bytes = stored_bytes(whole);
  const auto piece_bytes = static_cast<std::size_t>(tiled() ? TIFFTileSize(tiff_.get()) : TIFFStripSize(tiff_.get()));
  if (piece_bytes != row_bytes * down) return damaged_tiff(path_, "its pieces have no size");
  const std::unique_ptr<std::byte[]> buffer = std::make_unique_for_overwrite<std::byte[]>(piece_bytes);
  messages_.error.clear();
  messages_.decoding = true;
  std::uint32_t piece = 0;
  std::span<std::byte> page;  // as far as there is room
  for (std::size_t y = 0; y < height; y += down)
    for (std::size_t x = 0; x < width; x += across, ++piece) {
      const std::size_t rows = std::min(down, height - y);
      const auto wanted = static_cast<tmsize_t>(row_bytes * (tiled() ? down : rows));
      const tmsize_t got = tiled() ? TIFFReadEncodedTile(tiff_.get(), piece, buffer.get(), wanted)
                                   : TIFFReadEncodedStrip(tiff_.get(), piece, buffer.get(), wanted);
      if (got != wanted || !messages_.error.empty()) return undecoded();
      if (x == 0) {
        const auto added = room(rows * width * value_bytes);
        if (!added) return fail(added.error());
        page = {y == 0 ? added->data() : page.data(), page.size() + added->size()};
      }
      TiffRow row = kind.row;
      row.pixels = std::min(across, width - x);
      for (std::size_t r = 0; r < rows; ++r)
        unpack_row(row, std::span(buffer.get() + r * row_bytes, row_bytes),
                   page.subspan(((y + r) * width + x) * value_bytes, row.pixels * value_bytes));
    }
  messages_.decoding = false;
  turn_page(kind, page);
  return {};
}

}  // namespace

Result<PicturePages> tiff_pages(const fs::path& path) {
  TiffFile file(path);
  if (auto opened = file.open(); !opened) return fail(opened.error());
  std::optional<PicturePages> first;
  for (Result<bool> more = true;; more = file.next_page()) {
    if (!more) return fail(more.error());
    if (!*more) break;
    const auto kind = file.page_kind();
    if (!kind) return fail(kind.error());
    if (first && kind->pages != PicturePages{first->width, first->height, 1, first->values})
      return fail(path.string(), "has pages of different sizes or types; save those of one stack");
    if (auto there = file.check_pixels(*kind); !there) return fail(there.error());
    if (!first)
      first = kind->pages;
    else
      ++first->pages;
  }
  TiffFile again(path);  // ImageJ describes a stack on its first page
  if (auto opened = again.open(); !opened) return fail(opened.error());
  if (auto described = again.check_description(first->pages); !described) return fail(described.error());
  return *first;
}

Result<void> read_tiff_pages(const fs::path& path, const PicturePages& expected, const PageRoom& room) {
  TiffFile file(path);
  if (auto opened = file.open(); !opened) return opened;
  int pages = 0;
  for (Result<bool> more = true;; more = file.next_page()) {
    if (!more) return fail(more.error());
    if (!*more) break;
    const auto kind = file.page_kind();
    if (!kind) return fail(kind.error());
    if (kind->pages != PicturePages{expected.width, expected.height, 1, expected.values} || ++pages > expected.pages)
      return damaged_tiff(path, "it changed while it was read");
    if (auto there = file.check_pixels(*kind); !there) return there;
    if (auto read = file.read_page(*kind, room); !read) return read;
  }
  if (pages != expected.pages) return damaged_tiff(path, "it changed while it was read");
  return {};
}

}  // namespace homolog
