#include "core/base/text/text.h"

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

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const auto begin = text.find_first_not_of(blanks);
  return begin == text.npos ? std::string_view() : text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

char table_separator(std::string_view first_line) {
  for (const char one : {',', '\t', ';'})
    if (first_line.find(one) != first_line.npos) return one;
  return ',';
}

std::vector<std::string> csv_fields(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"' && quoted && k + 1 < line.size() && line[k + 1] == '"')
      cells.back() += line[k++];
    else if (line[k] == '"')
      quoted = !quoted;
    else if (line[k] == separator && !quoted)
      cells.emplace_back();
    else
      cells.back() += line[k];
  }
  return cells;
}

std::vector<std::string> table_cells(std::string_view line, char separator) {
  auto cells = csv_fields(line, separator);
  for (std::string& cell : cells) cell = std::string(trimmed(cell));
  return cells;
}

}  // namespace homolog
