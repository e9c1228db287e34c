#include "core/base/text/text_table.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/files/files.h"
#include "core/base/text/system_text.h"
#include "core/base/text/text.h"

namespace homolog {

namespace {

/// The separator that a first line as "sep=;" names, as Excel writes and reads it.
std::optional<char> named_separator(std::string_view line) {
  line = trimmed(line);
  if (line.size() > 1 && line.starts_with('"') && line.ends_with('"')) line = line.substr(1, line.size() - 2);
  if (line.size() != 5 || lower_case(std::string(line.substr(0, 4))) != "sep=") return std::nullopt;
  return line.back();
}

/// Whether every row has one cell more than there are columns.
bool lacks_a_column(const TextTable& table) {
  return !table.rows.empty() &&
         std::ranges::all_of(table.rows, [&](const auto& row) { return row.size() == table.columns.size() + 1; });
}

/// Takes out the numbers 1, 2, … before the rows, which R's write.table quotes and gives no column.
void take_row_numbers_out(TextTable& table) {
  if (!lacks_a_column(table)) return;
  for (std::size_t k = 0; k < table.rows.size(); ++k)
    if (table.rows[k].front() != std::to_string(k + 1)) return;
  for (auto& row : table.rows) row.erase(row.begin());
}

Result<void> check_lengths(const std::filesystem::path& path, const TextTable& table) {
  for (std::size_t k = 0; k < table.rows.size(); ++k) {
    if (table.rows[k].size() == table.columns.size()) continue;
    return fail(path.string(), "line " + std::to_string(table.lines[k]) + " has " +
                                   std::to_string(table.rows[k].size()) + " cells where the first line names " +
                                   std::to_string(table.columns.size()) + "; correct it" +
                                   (lacks_a_column(table) ? ", or write it with col.names = NA where R's write.table "
                                                            "wrote it with names of its rows"
                                                          : ""));
  }
  return {};
}

}  // namespace

Result<TextTable> read_text_table(const std::filesystem::path& path) {
  auto text = read_whole_file(path, std::uintmax_t{1} << 25);
  if (!text) return fail(text.error());
  if (text->starts_with("\xFF\xFE") || text->starts_with("\xFE\xFF"))
    return fail(path.string(), "is a table in UTF-16; save it as CSV in UTF-8");
  if (text->find('\0') != std::string::npos) return fail(path.string(), "is no text; save the table as CSV in UTF-8");
  if (text->starts_with("\xEF\xBB\xBF")) text->erase(0, 3);
  if (text->find('\n') == std::string::npos) std::replace(text->begin(), text->end(), '\r', '\n');
  TextTable table;
  std::size_t number = 0;
  std::optional<char> separator;
  bool all_quoted = true;  // each line begins with a quote
  for (std::size_t at = 0; at < text->size();) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    const std::string_view line = std::string_view(*text).substr(at, end - at);
    at = end + 1;
    ++number;
    if (line.find_first_not_of(" \t\r,;") == std::string_view::npos) continue;
    if (table.columns.empty() && !separator && (separator = named_separator(line))) continue;
    if (table.columns.empty()) table.separator = separator.value_or(table_separator(line));
    auto cells = table_cells(line, table.separator);
    all_quoted = all_quoted && line.starts_with('"');
    if (table.columns.empty()) {
      table.columns = std::move(cells);
      continue;
    }
    table.rows.push_back(std::move(cells));
    table.lines.push_back(number);
  }
  if (all_quoted) take_row_numbers_out(table);
  if (auto checked = check_lengths(path, table); !checked) return fail(checked.error());
  return table;
}

std::string mend_encoding(TextTable& table) {
  bool mended = false;
  const auto mend = [&](std::string& cell) {
    if (is_utf8(cell)) return;
    auto text = utf8_of(cell, "WINDOWS-1252");
    if (!text) text = utf8_of(cell, "ISO-8859-1");
    if (!text) return;
    cell = std::move(*text);
    mended = true;
  };
  std::ranges::for_each(table.columns, mend);
  for (auto& row : table.rows) std::ranges::for_each(row, mend);
  return mended ? "is no UTF-8, so it was read as Windows-1252 (Latin-1); save it as CSV in UTF-8" : "";
}

namespace {

/// "0,5" as "0.5"; of other text nothing.
std::optional<std::string> with_decimal_point(const std::string& cell) {
  const std::size_t comma = cell.find(',');
  if (comma == cell.npos || cell.find_first_of(".,", comma + 1) != cell.npos || cell.find('.') < comma)
    return std::nullopt;
  std::string number = cell;
  number[comma] = '.';
  return as_number<double>(number) ? std::optional(number) : std::nullopt;
}

/// Whether the comma may part thousands: "1,234", and not "0,234" or "1,23".
bool may_be_thousands(std::string_view cell) {
  if (cell.starts_with('-') || cell.starts_with('+')) cell.remove_prefix(1);
  const std::size_t comma = cell.find(',');
  return comma >= 1 && comma <= 3 && cell.front() != '0' && cell.size() == comma + 4 &&
         cell.find_first_not_of("0123456789,") == cell.npos;
}

/// A column of numbers of which some have commas, with points in their place; nothing where it is another.
Result<std::vector<std::string>> column_with_points(const std::filesystem::path& path, const TextTable& table,
                                                    std::size_t column) {
  std::vector<std::string> mended;
  std::size_t with_comma = table.rows.size(), with_point = table.rows.size();  // the first such row
  bool only_thousands = true;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::string& cell = table.rows[i][column];
    auto number = with_decimal_point(cell);
    if (!number && !is_missing(cell) && !as_number<double>(cell)) return std::vector<std::string>();
    if (number) {
      with_comma = std::min(with_comma, i);
      only_thousands = only_thousands && may_be_thousands(cell);
    } else if (!is_missing(cell) && cell.find('.') != cell.npos) {
      with_point = std::min(with_point, i);
    }
    mended.push_back(number ? std::move(*number) : cell);
  }
  if (with_comma == table.rows.size()) return std::vector<std::string>();
  const auto cell_of = [&](std::size_t i) {
    return table.rows[i][column] + " in line " + std::to_string(table.lines[i]);
  };
  if (with_point < table.rows.size())
    return fail(path.string(), "has " + cell_of(with_comma) + " and " + cell_of(with_point) + " in the column " +
                                   table.columns[column] + "; write all its numbers with points");
  if (only_thousands)
    return fail(path.string(), "has " + cell_of(with_comma) + " in the column " + table.columns[column] +
                                   ", whose comma may part thousands or decimals; write numbers with points and "
                                   "nothing between thousands");
  return mended;
}

}  // namespace

bool is_missing(std::string_view cell) {
  const std::string small = lower_case(std::string(trimmed(cell)));
  constexpr std::array<std::string_view, 6> words{"", "na", "n/a", "nan", ".", "?"};
  return std::find(words.begin(), words.end(), small) != words.end();
}

Result<void> mend_decimal_commas(const std::filesystem::path& path, TextTable& table,
                                 const std::function<bool(const std::string& column)>& of_text) {
  if (table.separator == ',') return {};
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    if (of_text && of_text(table.columns[k])) continue;
    auto mended = column_with_points(path, table, k);
    if (!mended) return fail(mended.error());
    for (std::size_t i = 0; i < mended->size(); ++i) table.rows[i][k] = std::move((*mended)[i]);
  }
  return {};
}

}  // namespace homolog
