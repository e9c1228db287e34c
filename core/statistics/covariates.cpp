#include "core/statistics/covariates.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

#include "core/base/files.h"
#include "core/base/text.h"

namespace homolog {

namespace {

std::size_t column_of_names(const std::vector<std::string>& columns) {
  for (const char* word : {"name", "case", "id"})
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (lower_case(columns[k]) == word) return k;
  return 0;
}

Result<void> refuse_twice(const std::string& source, const char* what, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) return fail(source, std::string("has the ") + what + " " + name + " twice");
  return {};
}

}  // namespace

std::optional<std::size_t> CovariateTable::column(std::string_view name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

bool is_missing(std::string_view cell) {
  const std::string small = lower_case(std::string(trimmed(cell)));
  constexpr std::array<std::string_view, 6> words{"", "na", "n/a", "nan", ".", "?"};
  return std::find(words.begin(), words.end(), small) != words.end();
}

Result<CovariateTable> read_covariates(const std::filesystem::path& path) {
  auto text = read_whole_file(path, std::uintmax_t{1} << 25);
  if (!text) return fail(text.error());
  if (text->starts_with("\xEF\xBB\xBF")) text->erase(0, 3);
  CovariateTable table{path.string(), {}, {}, {}};
  std::size_t names = 0, number = 0;
  char separator = ',';
  for (std::size_t at = 0; at < text->size();) {
    const std::size_t end = std::min(text->find('\n', at), text->size());
    const std::string_view line = std::string_view(*text).substr(at, end - at);
    at = end + 1;
    ++number;
    if (line.find_first_not_of(" \t\r,;") == std::string_view::npos) continue;
    if (table.columns.empty()) {
      separator = table_separator(line);
      table.columns = table_cells(line, separator);
      names = column_of_names(table.columns);
      continue;
    }
    auto cells = table_cells(line, separator);
    const std::string where = "line " + std::to_string(number);
    if (cells.size() != table.columns.size())
      return fail(table.source, where + " has " + std::to_string(cells.size()) + " cells where the first line names " +
                                    std::to_string(table.columns.size()) + "; correct it");
    if (cells[names].empty()) return fail(table.source, where + " names no case; correct it");
    table.cases.push_back(std::move(cells[names]));
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(names));
    table.cells.push_back(std::move(cells));
  }
  if (table.cases.empty()) return fail(table.source, "has no cases; give a line with the columns and one a case");
  table.columns.erase(table.columns.begin() + static_cast<std::ptrdiff_t>(names));
  if (auto once = refuse_twice(table.source, "column", table.columns); !once) return fail(once.error());
  if (auto once = refuse_twice(table.source, "case", table.cases); !once) return fail(once.error());
  return table;
}

}  // namespace homolog
