#include "core/base/pictures/colour.h"

#include <charconv>
#include <cstdio>

namespace homolog {

std::string hex_of(const std::array<std::uint8_t, 3>& colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

std::optional<std::array<std::uint8_t, 3>> colour_from_hex(const std::string& text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    const char* from = text.data() + 1 + 2 * c;
    if (std::from_chars(from, from + 2, colour[c], 16).ptr != from + 2) return std::nullopt;
  }
  return colour;
}

}  // namespace homolog
