#pragma once

#include <cstddef>
#include <span>

#include "core/base/pictures/picture_module.h"

namespace homolog {

/// How one row of a TIFF's samples lies in memory once it is decoded.
struct TiffRow {
  std::size_t pixels = 0;
  int bits = 8;             ///< bits of one sample: 1…16, 32 or 64
  int samples = 1;          ///< samples of one pixel; the first is taken
  bool white_is_0 = false;  ///< whole numbers of up to 8 bits are turned round
  Scalar values = Scalar::uint8;
};

/// How many bytes the decoded row takes.
std::size_t stored_bytes(const TiffRow& row);

/// Takes the first sample of each pixel. Samples of up to 7 bits are spread over 0…255; those of 9 to 15 keep their
/// values in 16 bits. `from` has stored_bytes, `to` has as many values as there are pixels.
void unpack_row(const TiffRow& row, std::span<const std::byte> from, std::span<std::byte> to);

}  // namespace homolog
