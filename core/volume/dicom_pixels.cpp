#include "core/volume/dicom_pixels.h"

#include <gdcmImage.h>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>

#include <array>
#include <cstring>
#include <type_traits>

#include "core/volume/readers.h"

// Encoded pixels (RLE, JPEG, JPEG-LS, JPEG 2000) through GDCM, the library behind ITK's reader. It is called directly
// because ITK hides what is needed to refuse missing pixels and to place the planes of enhanced files.
namespace homolog {
namespace {

tl::unexpected<Error> pixels_missing(const DicomHeader& header) {
  return fail(header.path.string(), "is cut short: pixels are missing; copy or download it again");
}

void silence_gdcm() {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
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

Result<void> decode(const DicomHeader& header, std::span<std::byte> out) {
  silence_gdcm();
  gdcm::ImageReader reader;
  reader.SetFileName(header.path.c_str());
  if (!reader.Read() || reader.GetImage().GetBufferLength() != out.size() ||
      !reader.GetImage().GetBuffer(reinterpret_cast<char*>(out.data())))
    return fail(header.path.string(), "holds pixels that do not decode; copy it again or export it uncompressed");
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
  if (header.pixels->fragments == 0) return read_plain(header, *type, out, progress);
  if (header.pixels->fragments < header.planes.size()) return pixels_missing(header);
  return decode(header, out);
}

}  // namespace homolog
