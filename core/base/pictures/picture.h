#pragma once

#include <cstdint>
#include <vector>

namespace homolog {

/// 8-bit RGBA, top row first, not premultiplied.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 · width · height
};

}  // namespace homolog
