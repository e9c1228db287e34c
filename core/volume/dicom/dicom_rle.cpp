#include "core/volume/dicom/dicom_rle.h"

#include <array>
#include <bit>
#include <cstdint>

namespace homolog {

namespace {

constexpr std::size_t rle_header_bytes = 64, most_segments = 15;

std::uint32_t rle_number_at(std::span<const char> bytes, std::size_t offset) {
  std::uint32_t number = 0;
  for (std::size_t b = 4; b-- > 0;) number = number << 8 | static_cast<unsigned char>(bytes[offset + b]);
  return number;
}

/// One segment into every `step`th byte of `out`, which it fills exactly.
bool decode_segment(std::span<const char> segment, std::span<std::byte> out, std::size_t step) {
  std::size_t to = 0, from = 0;
  while (to < out.size()) {
    if (from >= segment.size()) return false;
    const int code = static_cast<signed char>(segment[from++]);
    if (code == -128) continue;
    const bool run = code < 0;
    const auto count = static_cast<std::size_t>(run ? 1 - code : code + 1);
    if (segment.size() - from < (run ? 1 : count)) return false;
    for (std::size_t i = 0; i < count; ++i, to += step) {
      if (to >= out.size()) return false;
      out[to] = static_cast<std::byte>(segment[from + (run ? 0 : i)]);
    }
    from += run ? 1 : count;
  }
  return true;
}

}  // namespace

bool decode_rle(std::span<const char> fragment, std::size_t value_bytes, std::span<std::byte> out) {
  if (fragment.size() < rle_header_bytes || value_bytes < 1 || value_bytes > most_segments) return false;
  if (rle_number_at(fragment, 0) != value_bytes) return false;
  std::array<std::size_t, most_segments + 1> begins{};
  for (std::size_t s = 0; s < value_bytes; ++s) begins[s] = rle_number_at(fragment, 4 * (s + 1));
  begins[value_bytes] = fragment.size();
  if (begins[0] < rle_header_bytes) return false;
  for (std::size_t s = 0; s < value_bytes; ++s) {
    if (begins[s] >= begins[s + 1]) return false;
    // The most significant byte comes first.
    const std::size_t byte = std::endian::native == std::endian::big ? s : value_bytes - 1 - s;
    if (!decode_segment(fragment.subspan(begins[s], begins[s + 1] - begins[s]), out.subspan(byte), value_bytes))
      return false;
  }
  return true;
}

}  // namespace homolog
