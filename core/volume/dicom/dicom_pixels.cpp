#include "core/volume/dicom/dicom_pixels.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/pictures/picture_module.h"
#include "core/base/processes/process.h"
#include "core/base/text/text.h"
#include "core/volume/dicom/codestream.h"
#include "core/volume/dicom/dicom_rle.h"
#include "core/volume/readers.h"

// Pixels as they are or run-length encoded are read here; those of the JPEG family by the picture module.
namespace homolog {
namespace {

tl::unexpected<Error> pixels_missing(const DicomHeader& header) {
  return fail(header.path.string(), "is cut short: pixels are missing; copy or download it again");
}

/// The stored bits of each value, shifted down and sign-extended; other bits may hold overlays.
template <class T>
void take_stored_bits(std::span<std::byte> bytes, const DicomHeader& header) {
  using Unsigned = std::make_unsigned_t<T>;
  const int width = static_cast<int>(8 * sizeof(T));
  const int above = width - 1 - header.high_bit, below = width - header.bits_stored;
  for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
    Unsigned value;
    std::memcpy(&value, bytes.data() + i, sizeof value);
    const T shifted = static_cast<T>(static_cast<Unsigned>(value << above));
    const T result = static_cast<T>(shifted >> below);
    std::memcpy(bytes.data() + i, &result, sizeof result);
  }
}

/// take_stored_bits in the file's type.
void take_stored_bits(std::span<std::byte> bytes, Scalar type, const DicomHeader& header) {
  if (header.bits_stored == header.bits_allocated) return;
  switch (type) {
    case Scalar::uint8:
      return take_stored_bits<std::uint8_t>(bytes, header);
    case Scalar::int8:
      return take_stored_bits<std::int8_t>(bytes, header);
    case Scalar::uint16:
      return take_stored_bits<std::uint16_t>(bytes, header);
    case Scalar::int16:
      return take_stored_bits<std::int16_t>(bytes, header);
    case Scalar::uint32:
      return take_stored_bits<std::uint32_t>(bytes, header);
    default:
      return take_stored_bits<std::int32_t>(bytes, header);
  }
}

std::size_t plane_bytes_of(const DicomHeader& header, Scalar type) {
  return static_cast<std::size_t>(header.rows) * static_cast<std::size_t>(header.columns) * size_of(type);
}

Result<void> read_plain(const DicomHeader& header, Scalar type, const Room& room, Progress* progress) {
  const std::size_t bytes = header.planes.size() * plane_bytes_of(header, type);
  if (header.pixels->bytes < bytes) return pixels_missing(header);
  const std::span<std::byte> out = room(bytes);
  if (auto read = read_block(header.pixels->block, out, progress); !read) return read;
  if (header.big_endian != native_big_endian()) swap_byte_order(out, type);
  take_stored_bits(out, type, header);
  return {};
}

tl::unexpected<Error> not_decodable(const DicomHeader& header) {
  return fail(header.path.string(), "holds pixels that do not decode; copy it again or export it uncompressed");
}

/// Streams of the JPEG family end with the marker FFD9, perhaps padded; decoders make up what a cut one lacks.
bool is_closed(const std::string& transfer_syntax, const std::vector<char>& stream) {
  if (!transfer_syntax.starts_with("1.2.840.10008.1.2.4.")) return true;
  const auto last = std::find_if(stream.rbegin(), stream.rend(), [](char c) { return c != 0; });
  return stream.rend() - last >= 2 && last[0] == '\xd9' && last[1] == '\xff';
}

constexpr std::string_view rle_syntax = "1.2.840.10008.1.2.5", jpeg_2000_syntax = "1.2.840.10008.1.2.4.9";

/// Whether a stream of the JPEG family is a grey picture of the header's size. Asked before the decoder is, which takes
/// memory for whatever the stream says.
bool has_header_size(const DicomHeader& header, std::span<const char> stream) {
  const auto size = header.transfer_syntax.starts_with(jpeg_2000_syntax) ? jpeg2000_size(stream) : jpeg_size(stream);
  return size == CodestreamSize{header.columns, header.rows, 1};
}

/// Decodes one plane of the JPEG family.
bool decode_jpeg(const PictureModule& module, const DicomHeader& header, std::span<const char> stream,
                 std::span<std::byte> out) {
  const SilencedErrors silence;
  return module.decode_jpeg({header.transfer_syntax, header.columns, header.rows, header.bits_allocated,
                             header.bits_stored, header.high_bit, header.is_signed},
                            stream, out);
}

/// The transfer syntaxes in which pixels can be decoded: run lengths, each frame deflated, and of the JPEG family those
/// that the picture module knows.
constexpr std::string_view deflated_frames_syntax = "1.2.840.10008.1.2.8.1";
constexpr std::array<std::string_view, 11> decoded_syntaxes{rle_syntax,
                                                            deflated_frames_syntax,
                                                            "1.2.840.10008.1.2.4.50",
                                                            "1.2.840.10008.1.2.4.51",
                                                            "1.2.840.10008.1.2.4.57",
                                                            "1.2.840.10008.1.2.4.70",
                                                            "1.2.840.10008.1.2.4.80",
                                                            "1.2.840.10008.1.2.4.81",
                                                            "1.2.840.10008.1.2.4.90",
                                                            "1.2.840.10008.1.2.4.91",
                                                            "1.2.840.10008.1.2.4.92"};

/// "1.2.840.10008.1.2.4.201 (High-Throughput JPEG 2000)" [DICOM PS3.6, table A-1].
std::string named_syntax(const std::string& uid) {
  constexpr std::array<std::pair<std::string_view, const char*>, 15> names{
      {{"1.2.840.10008.1.2.4.50", "JPEG Baseline"},
       {"1.2.840.10008.1.2.4.51", "JPEG Extended"},
       {"1.2.840.10008.1.2.4.57", "JPEG Lossless"},
       {"1.2.840.10008.1.2.4.70", "JPEG Lossless"},
       {"1.2.840.10008.1.2.4.80", "JPEG-LS Lossless"},
       {"1.2.840.10008.1.2.4.81", "JPEG-LS Near-lossless"},
       {"1.2.840.10008.1.2.4.90", "JPEG 2000 Lossless"},
       {"1.2.840.10008.1.2.4.91", "JPEG 2000"},
       {"1.2.840.10008.1.2.4.100", "MPEG2"},
       {"1.2.840.10008.1.2.4.110", "JPEG XL Lossless"},
       {"1.2.840.10008.1.2.4.201", "High-Throughput JPEG 2000 Lossless"},
       {"1.2.840.10008.1.2.4.202", "High-Throughput JPEG 2000 RPCL"},
       {"1.2.840.10008.1.2.4.203", "High-Throughput JPEG 2000"},
       {"1.2.840.10008.1.2.2", "Explicit VR Big Endian"},
       {rle_syntax, "RLE Lossless"}}};
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& name) { return name.first == uid; });
  return found == names.end() ? excerpt(uid) : uid + " (" + found->second + ")";
}

tl::unexpected<Error> unreadable_syntax(const DicomHeader& header) {
  return fail(header.path.string(), "keeps its pixels in the transfer syntax " + named_syntax(header.transfer_syntax) +
                                        ", which cannot be read; export it uncompressed (Explicit VR Little Endian)");
}

/// Those that change values: JPEG but for its lossless kinds, and near-lossless JPEG-LS.
constexpr std::array<std::string_view, 3> lossy_syntaxes{"1.2.840.10008.1.2.4.50", "1.2.840.10008.1.2.4.51",
                                                         "1.2.840.10008.1.2.4.81"};

/// A plane that is deflated by itself, into room of its size.
Result<void> inflate_plane(const DicomHeader& header, std::size_t plane, std::span<std::byte> out) {
  const DicomPixels::Fragment& fragment = header.pixels->fragments[plane];
  const ByteBlock block{.file = header.path, .offset = fragment.offset, .compression = Compression::RawDeflate};
  if (auto read = read_block(block, out, nullptr); !read) return read;
  return {};
}

/// The encoded bytes of one plane: its own fragment, or all of them where there is a single plane.
std::optional<std::vector<char>> encoded_plane(const DicomHeader& header, std::size_t plane, std::istream& in) {
  const std::span all(header.pixels->fragments);
  std::vector<char> stream;
  for (const auto& piece : header.planes.size() == 1 ? all : all.subspan(plane, 1)) {
    const std::size_t before = stream.size();
    stream.resize(before + piece.bytes);
    in.seekg(static_cast<std::streamoff>(piece.offset));
    if (!in.read(stream.data() + before, piece.bytes)) return {};
  }
  return stream;
}

/// Decodes every plane from its fragments.
Result<void> decode(const DicomHeader& header, Scalar type, const Room& room, Progress* progress) {
  const std::size_t planes = header.planes.size(), fragments = header.pixels->fragments.size();
  const bool run_lengths = is_run_length_encoded(header);
  if (std::find(decoded_syntaxes.begin(), decoded_syntaxes.end(), header.transfer_syntax) == decoded_syntaxes.end())
    return unreadable_syntax(header);
  if (fragments < planes) return pixels_missing(header);
  if ((planes > 1 || run_lengths) && fragments != planes)
    return fail(header.path.string(), "keeps its frames in pieces; export it uncompressed");
  const bool is_deflated = header.transfer_syntax == deflated_frames_syntax;
  const auto module = run_lengths || is_deflated ? Result<const PictureModule*>(nullptr) : picture_module();
  if (!module) return fail(module.error());
  std::ifstream in(header.path, std::ios::binary);
  for (std::size_t p = 0; p < planes; ++p) {
    if (progress) {
      if (progress->cancelled()) return fail(header.path.string(), "was not read: cancelled");
      progress->report(static_cast<double>(p) / static_cast<double>(planes));
    }
    if (is_deflated) {
      const std::span<std::byte> out = room(plane_bytes_of(header, type));
      if (auto inflated = inflate_plane(header, p, out); !inflated) return inflated;
      if (header.big_endian != native_big_endian()) swap_byte_order(out, type);
      take_stored_bits(out, type, header);
      continue;
    }
    const auto stream = encoded_plane(header, p, in);
    if (!stream || !is_closed(header.transfer_syntax, *stream)) return pixels_missing(header);
    if (!run_lengths && !has_header_size(header, *stream)) return not_decodable(header);
    const std::span<std::byte> out = room(plane_bytes_of(header, type));
    if (run_lengths ? !decode_rle(*stream, size_of(type), out) : !decode_jpeg(**module, header, *stream, out))
      return not_decodable(header);
    if (run_lengths) take_stored_bits(out, type, header);
  }
  return {};
}

}  // namespace

Result<Scalar> dicom_stored_type(const DicomHeader& header) {
  const std::string name = header.path.string();
  if (header.samples_per_pixel != 1 || (!header.photometric.empty() && !header.photometric.starts_with("MONOCHROME")))
    return fail(name, "is a colour image; export it as greyscale");
  const bool sane = header.bits_stored >= 1 && header.bits_stored <= header.bits_allocated &&
                    header.high_bit >= header.bits_stored - 1 && header.high_bit < header.bits_allocated;
  if (sane && header.bits_allocated == 8) return header.is_signed ? Scalar::int8 : Scalar::uint8;
  if (sane && header.bits_allocated == 16) return header.is_signed ? Scalar::int16 : Scalar::uint16;
  if (sane && header.bits_allocated == 32) return header.is_signed ? Scalar::int32 : Scalar::uint32;
  return fail(name, "stores its pixels in " + std::to_string(header.bits_stored) + " of " +
                        std::to_string(header.bits_allocated) + " bits, which cannot be read; export it with 8 or 16");
}

bool is_run_length_encoded(const DicomHeader& header) {
  return header.transfer_syntax == rle_syntax;
}

Result<void> check_pixel_claim(const DicomHeader& header, std::size_t plane_bytes) {
  const double claimed = static_cast<double>(plane_bytes) * static_cast<double>(header.planes.size());
  // An evenly grey picture of 512 × 512 takes about a hundred bytes in JPEG 2000. Deflated pixels have been counted.
  constexpr double best_ratio = 20000, best_run_ratio = 64;
  const bool packed = !header.pixels->fragments.empty();
  const double ratio = !packed ? 1 : is_run_length_encoded(header) ? best_run_ratio : best_ratio;
  if (claimed > static_cast<double>(header.pixels->bytes) * ratio) return pixels_missing(header);
  // Decoders take up to eight bytes a pixel at once, before they know whether there are any. Mammograms have 28
  // million.
  constexpr double most_pixels = 30e6;
  if (packed && static_cast<double>(header.rows) * header.columns > most_pixels)
    return fail(header.path.string(), "has compressed planes of more than 30 million pixels; export it uncompressed");
  return {};
}

Result<void> check_exact(const DicomHeader& header) {
  if (std::ranges::find(lossy_syntaxes, header.transfer_syntax) == lossy_syntaxes.end()) return {};
  return fail(header.path.string(), "keeps its labels in the transfer syntax " + named_syntax(header.transfer_syntax) +
                                        ", which changes them; export it uncompressed (Explicit VR Little Endian)");
}

Result<void> read_dicom_pixels(const DicomHeader& header, const Room& room, Progress* progress) {
  const auto type = dicom_stored_type(header);
  if (!type) return fail(type.error());
  return header.pixels->fragments.empty() ? read_plain(header, *type, room, progress)
                                          : decode(header, *type, room, progress);
}

Result<void> read_dicom_bits(const DicomHeader& header, std::size_t bytes, std::vector<std::byte>& bits,
                             Progress* progress) {
  const auto& fragments = header.pixels->fragments;
  if (header.big_endian || (!fragments.empty() && header.transfer_syntax != deflated_frames_syntax))
    return unreadable_syntax(header);
  constexpr double best_deflation = 1032;
  const double held = static_cast<double>(header.pixels->bytes) * (fragments.empty() ? 1 : best_deflation);
  if (held < static_cast<double>(bytes)) return pixels_missing(header);
  bits.resize(bytes);
  if (fragments.empty()) return read_block(header.pixels->block, bits, progress);
  const std::size_t planes = header.planes.size(), plane_bytes = bytes / planes;
  if (fragments.size() != planes) return pixels_missing(header);
  for (std::size_t p = 0; p < planes; ++p)
    if (auto read = inflate_plane(header, p, std::span(bits).subspan(p * plane_bytes, plane_bytes)); !read) return read;
  return {};
}

}  // namespace homolog
