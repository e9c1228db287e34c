#pragma once

#include <optional>
#include <span>

namespace homolog {

/// The size of a picture as its own encoded bytes state it.
struct CodestreamSize {
  int columns = 0, rows = 0, channels = 0;
  bool operator==(const CodestreamSize&) const = default;
};

/// Reads it from the frame header of a JPEG or JPEG-LS stream [ITU-T T.81, B.2.2; T.87, C.2.2]; nothing without one.
std::optional<CodestreamSize> jpeg_size(std::span<const char> stream);

/// Reads it from the SIZ marker of a JPEG 2000 stream [ITU-T T.800, A.5.1]; nothing without one.
std::optional<CodestreamSize> jpeg2000_size(std::span<const char> stream);

}  // namespace homolog
