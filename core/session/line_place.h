#pragma once

#include <cstdint>

namespace homolog {

/// The place of a line among those of a case, without its line feed; counted from the end of the first line, so that it
/// stays true when the case goes on in another file.
struct LinePlace {
  std::uint64_t at = 0, bytes = 0;
};

}  // namespace homolog
