#include "core/volume/dicom_pixels.h"

#include <fcntl.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <mutex>
#include <type_traits>
#include <vector>

#include "core/volume/readers.h"

// Encoded pixels (RLE, JPEG, JPEG-LS, JPEG 2000) through GDCM, the library behind ITK's reader. Only its decoders are
// used: its parser fills missing pixels with zeros and, as Debian builds it, aborts the program on damaged files.
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

void swap_pairs(std::span<std::byte> bytes, std::size_t size) {
  for (std::size_t i = 0; i + size <= bytes.size(); i += size) std::reverse(&bytes[i], &bytes[i] + size);
}

Result<void> read_plain(const DicomHeader& header, StoredType type, std::span<std::byte> out, Progress* progress) {
  if (header.pixels->bytes < out.size()) return pixels_missing(header);
  if (auto read = read_block(header.pixels->block, out, progress); !read) return read;
  if (const std::size_t size = bytes_per_voxel(type); size > 1 && header.big_endian != native_big_endian())
    swap_pairs(out, size);
  if (header.bits_stored == header.bits_allocated) return {};
  switch (type) {
    case StoredType::Uint8:
      take_stored_bits<std::uint8_t>(out, header);
      break;
    case StoredType::Int8:
      take_stored_bits<std::int8_t>(out, header);
      break;
    case StoredType::Uint16:
      take_stored_bits<std::uint16_t>(out, header);
      break;
    case StoredType::Int16:
      take_stored_bits<std::int16_t>(out, header);
      break;
    case StoredType::Uint32:
      take_stored_bits<std::uint32_t>(out, header);
      break;
    default:
      take_stored_bits<std::int32_t>(out, header);
      break;
  }
  return {};
}

tl::unexpected<Error> not_decodable(const DicomHeader& header) {
  return fail(header.path.string(), "holds pixels that do not decode; copy it again or export it uncompressed");
}

/// The decoders of JPEG print on file descriptor 2 what they dislike, whatever GDCM is told.
class SilencedErrors {
 public:
  SilencedErrors() : lock_(mutex()) {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    std::fflush(stderr);
    before_ = ::dup(STDERR_FILENO);
    if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
      ::dup2(nowhere, STDERR_FILENO);
      ::close(nowhere);
    }
  }
  ~SilencedErrors() {
    std::fflush(stderr);
    if (before_ < 0) return;
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
  }
  SilencedErrors(const SilencedErrors&) = delete;
  SilencedErrors& operator=(const SilencedErrors&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex only;
    return only;
  }
  std::lock_guard<std::mutex> lock_;
  int before_ = -1;
};

/// Streams of the JPEG family end with the marker FFD9, perhaps padded; decoders make up what a cut one lacks.
bool is_closed(const std::string& transfer_syntax, const std::vector<char>& stream) {
  if (!transfer_syntax.starts_with("1.2.840.10008.1.2.4.")) return true;
  const auto last = std::find_if(stream.rbegin(), stream.rend(), [](char c) { return c != 0; });
  return stream.rend() - last >= 2 && last[0] == '\xd9' && last[1] == '\xff';
}

/// A picture that is given to GDCM without its file.
gdcm::Image empty_image(const DicomHeader& header, gdcm::TransferSyntax::TSType syntax) {
  gdcm::Image image;
  image.SetTransferSyntax(syntax);
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned>(header.columns));
  image.SetDimension(1, static_cast<unsigned>(header.rows));
  const auto bits = [](int count) { return static_cast<unsigned short>(count); };
  image.SetPixelFormat(gdcm::PixelFormat(1, bits(header.bits_allocated), bits(header.bits_stored),
                                         bits(header.high_bit), header.is_signed ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  return image;
}

/// Decodes every plane from its fragments: one each, or all of them for a single plane.
Result<void> decode(const DicomHeader& header, std::span<std::byte> out, Progress* progress) {
  const auto& fragments = header.pixels->fragments;
  const std::size_t planes = header.planes.size();
  if (fragments.size() < planes) return pixels_missing(header);
  if (planes > 1 && fragments.size() != planes)
    return fail(header.path.string(), "keeps its frames in pieces; export it uncompressed");
  const auto syntax = gdcm::TransferSyntax::GetTSType(header.transfer_syntax.c_str());
  if (syntax == gdcm::TransferSyntax::TS_END) return not_decodable(header);
  std::ifstream in(header.path, std::ios::binary);
  const std::size_t plane_bytes = out.size() / planes;
  for (std::size_t p = 0; p < planes; ++p) {
    if (progress) {
      if (progress->cancelled()) return fail(header.path.string(), "was not read: cancelled");
      progress->report(static_cast<double>(p) / static_cast<double>(planes));
    }
    const auto sequence = gdcm::SequenceOfFragments::New();
    std::vector<char> stream;
    for (const auto& piece : planes == 1 ? std::span(fragments) : std::span(fragments).subspan(p, 1)) {
      const std::size_t before = stream.size();
      stream.resize(before + piece.bytes);
      in.seekg(static_cast<std::streamoff>(piece.offset));
      if (!in.read(stream.data() + before, piece.bytes)) return pixels_missing(header);
      gdcm::Fragment fragment;
      fragment.SetByteValue(stream.data() + before, piece.bytes);
      sequence->AddFragment(fragment);
    }
    if (!is_closed(header.transfer_syntax, stream)) return pixels_missing(header);
    gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010), gdcm::VL(0xffffffff), gdcm::VR::OB);
    pixels.SetValue(*sequence);
    gdcm::Image image = empty_image(header, syntax);
    image.SetDataElement(pixels);
    const SilencedErrors silence;
    if (image.GetBufferLength() != plane_bytes ||
        !image.GetBuffer(reinterpret_cast<char*>(out.data() + p * plane_bytes)))
      return not_decodable(header);
  }
  return {};
}

}  // namespace

Result<StoredType> dicom_stored_type(const DicomHeader& header) {
  const std::string name = header.path.string();
  if (header.samples_per_pixel != 1 || (!header.photometric.empty() && !header.photometric.starts_with("MONOCHROME")))
    return fail(name, "is a colour image; export it as greyscale");
  const bool sane = header.bits_stored >= 1 && header.bits_stored <= header.bits_allocated &&
                    header.high_bit >= header.bits_stored - 1 && header.high_bit < header.bits_allocated;
  if (sane && header.bits_allocated == 8) return header.is_signed ? StoredType::Int8 : StoredType::Uint8;
  if (sane && header.bits_allocated == 16) return header.is_signed ? StoredType::Int16 : StoredType::Uint16;
  if (sane && header.bits_allocated == 32) return header.is_signed ? StoredType::Int32 : StoredType::Uint32;
  return fail(name, "stores its pixels in " + std::to_string(header.bits_stored) + " of " +
                        std::to_string(header.bits_allocated) + " bits, which cannot be read; export it with 8 or 16");
}

Result<void> read_dicom_pixels(const DicomHeader& header, std::span<std::byte> out, Progress* progress) {
  const auto type = dicom_stored_type(header);
  if (!type) return fail(type.error());
  return header.pixels->fragments.empty() ? read_plain(header, *type, out, progress) : decode(header, out, progress);
}

}  // namespace homolog
