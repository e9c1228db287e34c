#include "core/base/encoding/base64.h"

#include <array>
#include <cstdint>

namespace homolog {

namespace {

constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// The value that each letter stands for; 64 where it is none.
constexpr std::array<std::uint8_t, 256> make_values() {
  std::array<std::uint8_t, 256> values{};
  values.fill(64);
  for (std::size_t k = 0; k < letters.size(); ++k)
    values[static_cast<unsigned char>(letters[k])] = static_cast<std::uint8_t>(k);
  return values;
}
constexpr std::array<std::uint8_t, 256> letter_values = make_values();

}  // namespace

std::string to_base64(std::span<const unsigned char> bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t three = 0;
    for (std::size_t j = 0; j < 3; ++j) three = three << 8 | (k + j < bytes.size() ? bytes[k + j] : 0U);
    for (std::size_t j = 0; j < 4; ++j) text += k + j <= bytes.size() ? letters[three >> (18 - 6 * j) & 63U] : '=';
  }
  return text;
}

std::vector<unsigned char> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) return {};
  for (int k = 0; k < 2 && !text.empty() && text.back() == '='; ++k) text.remove_suffix(1);
  std::vector<unsigned char> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t four = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const std::uint8_t value = letter_values[static_cast<unsigned char>(text[k])];
    if (value == 64) return {};
    four = four << 6 | value;
    if (k % 4 > 0) bytes.push_back(static_cast<unsigned char>(four >> (6 - 2 * (k % 4))));
  }
  return bytes;
}

}  // namespace homolog
