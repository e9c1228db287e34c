#include "core/base/text_table.h"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include "core/base/files.h"
#include "core/base/text.h"

namespace homolog {

Result<TextTable> read_text_table(const std::filesystem::path& path) {
  auto text = read_whole_file(path, std::uintmax_t{1} << 25);
  if (!text) return fail(text.error());
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

std::optional<std::string> with_decimal_point(const std::string& cell) {
  const std::size_t comma = cell.find(',');
  if (comma == cell.npos || cell.find_first_of(".,", comma + 1) != cell.npos || cell.find('.') < comma)
    return std::nullopt;
  std::string number = cell;
  number[comma] = '.';
  return as_number<double>(number) ? std::optional(number) : std::nullopt;
}

}  // namespace homolog
