#include "core/base/text.h"

#include <cstdint>

namespace homolog {

namespace {

bool continues_character(char c) {
  return (static_cast<std::uint8_t>(c) & 0xc0) == 0x80;
}

/// The bytes of the UTF-8 character at the start of `text`; 1 where there is none.
std::size_t character_size(std::string_view text) {
  const auto first = static_cast<std::uint8_t>(text.front());
  const std::size_t size = first < 0xc2 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 1;
  if (size > text.size()) return 1;
  for (std::size_t i = 1; i < size; ++i)
    if (!continues_character(text[i])) return 1;
  return size;
}

/// The control characters of ASCII (0 to 31, 127) and Unicode (128 to 159), the latter also as single bytes.
bool is_control(std::string_view character) {
  const auto first = static_cast<std::uint8_t>(character.front());
  if (character.size() == 1) return first < 0x20 || first == 0x7f || (first >= 0x80 && first < 0xa0);
  return first == 0xc2 && static_cast<std::uint8_t>(character[1]) < 0xa0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const std::string_view character = text.substr(0, character_size(text));
    if (is_control(character))
      shown += '?';
    else
      shown += character;
    text.remove_prefix(character.size());
  }
  return shown;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    const auto first = static_cast<std::uint8_t>(text.front()), second = static_cast<std::uint8_t>(text[size - 1 > 0]);
    if (size == 1 && first >= 0x80) return false;
    // Too long a form, a half of a pair, beyond the last character.
    if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) || (first == 0xf0 && second < 0x90) ||
        (first == 0xf4 && second >= 0x90))
      return false;
    text.remove_prefix(size);
  }
  return true;
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t most_bytes = 200;
  if (text.size() <= most_bytes) return printable(text);
  std::size_t end = most_bytes;
  while (end > most_bytes - 4 && continues_character(text[end])) --end;  // no character is cut in two
  return printable(text.substr(0, end)) + "…";
}

}  // namespace homolog
