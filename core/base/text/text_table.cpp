#include "core/base/text/text_table.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "core/base/files/files.h"
#include "core/base/text/text.h"

namespace homolog {

Result<TextTable> read_text_table(const std::filesystem::path& path) {
  auto text = read_whole_file(path, std::uintmax_t{1} << 25);
  if (!text) return fail(text.error());
  if (text->starts_with("\xFF\xFE") || text->starts_with("\xFE\xFF"))
    return fail(path.string(), "is a table in UTF-16; save it as CSV in UTF-8");
  if (text->find('\0') != std::string::npos) return fail(path.string(), "is no text; save the table as CSV in UTF-8");
  if (text->starts_with("\xEF\xBB\xBF")) text->erase(0, 3);
  TextTable table;
  std::size_t number = 0;
  for (std::size_t at = 0; at < text->size();) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    const std::string_view line = std::string_view(*text).substr(at, end - at);
    at = end + 1;
    ++number;
    if (line.find_first_not_of(" \t\r,;") == std::string_view::npos) continue;
    if (table.columns.empty()) table.separator = table_separator(line);
    auto cells = table_cells(line, table.separator);
    if (table.columns.empty()) {
      table.columns = std::move(cells);
      continue;
    }
    if (cells.size() != table.columns.size())
      return fail(path.string(), "line " + std::to_string(number) + " has " + std::to_string(cells.size()) +
                                     " cells where the first line names " + std::to_string(table.columns.size()) +
                                     "; correct it");
    table.rows.push_back(std::move(cells));
    table.lines.push_back(number);
  }
  return table;
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
