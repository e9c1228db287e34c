#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace homolog {

/// A to Z in lower case, everything else as it is: file name endings and searches, the same in every locale.
inline std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// Text as a terminal may print it: a '?' for each control character, which could move the cursor or hide what follows.
/// Everything else stays, also bytes that are no UTF-8 (old file names).
std::string printable(std::string_view text);

/// The words of a file, as a message may quote them: printable, and the first 200 bytes followed by "…" where it is
/// longer.
std::string excerpt(std::string_view text);

/// Whether text can be written into JSON as it is: old file names may be bytes that are no UTF-8.
bool is_utf8(std::string_view text);

/// The text without spaces, tabs and line ends around it.
std::string_view trimmed(std::string_view text);

/// All of the text as a number of this type; none where it is not one, has a '+' before it or blanks around it.
template <class T>
std::optional<T> as_number(std::string_view text) {
  T number{};
  const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || after != text.data() + text.size()) return std::nullopt;
  return number;
}

/// The separator between the cells of a table, by its first line: a comma; where there is none, a tab or a semicolon.
char table_separator(std::string_view first_line);
/// The fields of a line of a table as they are. One in double quotes may hold separators, and quotes written twice.
std::vector<std::string> csv_fields(std::string_view line, char separator = ',');
/// The same, each trimmed.
std::vector<std::string> table_cells(std::string_view line, char separator);

/// Whether a name from elsewhere can be joined to a folder and stays in it.
inline bool is_file_name(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find_first_of(std::string_view("/\0", 2)) == name.npos;
}

}  // namespace homolog
