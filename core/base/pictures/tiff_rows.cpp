#include "core/base/pictures/tiff_rows.h"

#include <cstdint>
#include <cstring>

namespace homolog {

namespace {

/// Bits of a row, the most significant of each byte first [TIFF 6.0, "FillOrder"].
class Bits {
 public:
  explicit Bits(std::span<const std::byte> bytes) : bytes_(bytes) {}
  unsigned next(int count) {
    unsigned value = 0;
    for (; count > 0; --count, ++at_)
      value = value << 1 | (std::to_integer<unsigned>(bytes_[at_ / 8]) >> (7 - at_ % 8) & 1u);
    return value;
  }
  void skip(int count) { at_ += static_cast<std::size_t>(count); }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

template <class T>
void unpack_bits(const TiffRow& row, std::span<const std::byte> from, std::span<std::byte> to) {
  Bits bits(from);
  const unsigned highest = (1u << row.bits) - 1;
  for (std::size_t p = 0; p < row.pixels; ++p) {
    unsigned value = bits.next(row.bits);
    bits.skip(row.bits * (row.samples - 1));
    if (sizeof(T) == 1) value = value * 255 / highest;
    const T kept = static_cast<T>(value);
    std::memcpy(to.data() + p * sizeof kept, &kept, sizeof kept);
  }
}

}  // namespace

std::size_t stored_bytes(const TiffRow& row) {
  return (row.pixels * static_cast<std::size_t>(row.bits) * static_cast<std::size_t>(row.samples) + 7) / 8;
}

void unpack_row(const TiffRow& row, std::span<const std::byte> from, std::span<std::byte> to) {
  const auto value_bytes = static_cast<std::size_t>(row.bits) / 8, samples = static_cast<std::size_t>(row.samples);
  if (row.bits < 8)
    unpack_bits<std::uint8_t>(row, from, to);
  else if (row.bits % 8 != 0)
    unpack_bits<std::uint16_t>(row, from, to);
  else if (row.samples == 1)
    std::memcpy(to.data(), from.data(), row.pixels * value_bytes);
  else
    for (std::size_t p = 0; p < row.pixels; ++p)
      std::memcpy(to.data() + p * value_bytes, from.data() + p * samples * value_bytes, value_bytes);
  if (row.white_is_0 && row.values == Scalar::uint8)
    for (std::byte& value : to) value = ~value;
}

}  // namespace homolog
