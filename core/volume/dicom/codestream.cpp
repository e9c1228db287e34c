#include "core/volume/dicom/codestream.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace homolog {

namespace {

/// A number of `bytes` bytes, most significant first; the caller has checked that they are there.
std::uint32_t number_at(std::span<const char> stream, std::size_t at, std::size_t bytes) {
  std::uint32_t number = 0;
  for (std::size_t b = 0; b < bytes; ++b) number = number << 8 | static_cast<unsigned char>(stream[at + b]);
  return number;
}

/// SOF0…SOF15 without the tables among them, and the one of JPEG-LS.
bool begins_frame(std::uint32_t marker) {
  return (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) || marker == 0xf7;
}

}  // namespace

std::optional<CodestreamSize> jpeg_size(std::span<const char> stream) {
  if (stream.size() < 2 || number_at(stream, 0, 2) != 0xffd8) return {};
  for (std::size_t at = 2; at + 4 <= stream.size();) {
    if (number_at(stream, at, 1) != 0xff) return {};
    const std::uint32_t marker = number_at(stream, at + 1, 1);
    if (marker == 0xff) {  // padding
      ++at;
      continue;
    }
    constexpr std::uint32_t start_of_scan = 0xda, end_of_image = 0xd9;
    if (marker == start_of_scan || marker == end_of_image) return {};
    if (begins_frame(marker)) {
      if (at + 10 > stream.size()) return {};
      return CodestreamSize{static_cast<int>(number_at(stream, at + 7, 2)),
                            static_cast<int>(number_at(stream, at + 5, 2)),
                            static_cast<int>(number_at(stream, at + 9, 1))};
    }
    at += 2 + number_at(stream, at + 2, 2);
  }
  return {};
}

std::optional<CodestreamSize> jpeg2000_size(std::span<const char> stream) {
  constexpr std::array<char, 4> begin{'\xff', '\x4f', '\xff',
                                      '\x51'};  // behind the boxes of a JP2 file, where it is one
  const auto found = std::search(stream.begin(), stream.end(), begin.begin(), begin.end());
  const std::span<const char> siz = stream.subspan(static_cast<std::size_t>(found - stream.begin()));
  if (siz.size() < 42) return {};
  const std::uint32_t right = number_at(siz, 8, 4), below = number_at(siz, 12, 4), left = number_at(siz, 16, 4),
                      above = number_at(siz, 20, 4);
  constexpr std::uint32_t most = std::numeric_limits<int>::max();
  if (right <= left || below <= above || right - left > most || below - above > most) return {};
  return CodestreamSize{static_cast<int>(right - left), static_cast<int>(below - above),
                        static_cast<int>(number_at(siz, 40, 2))};
}

}  // namespace homolog
