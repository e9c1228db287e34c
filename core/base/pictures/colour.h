#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace homolog {

/// "#rrggbb", as files and case lines hold a colour (sRGB), and back (nothing for anything else).
std::string hex_of(const std::array<std::uint8_t, 3>& colour);
std::optional<std::array<std::uint8_t, 3>> colour_from_hex(const std::string& text);

}  // namespace homolog
