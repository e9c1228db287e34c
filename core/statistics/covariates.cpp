#include "core/statistics/covariates.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "core/base/text.h"
#include "core/base/text_table.h"

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

/// Columns of numbers with decimal commas get decimal points.
void mend_decimal_commas(TextTable& table) {
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    std::vector<std::string> mended;
    for (const auto& row : table.rows) {
      const auto number = with_decimal_point(row[k]);
      if (!number && !is_missing(row[k]) && !as_number<double>(row[k])) break;
      mended.push_back(number.value_or(row[k]));
    }
    if (mended.size() == table.rows.size())
      for (std::size_t i = 0; i < mended.size(); ++i) table.rows[i][k] = std::move(mended[i]);
  }
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
  auto read = read_text_table(path);
  if (!read) return fail(read.error());
  if (read->separator != ',') mend_decimal_commas(*read);
  CovariateTable table{path.string(), std::move(read->columns), {}, {}};
  const std::size_t names = column_of_names(table.columns);
  for (std::size_t k = 0; k < read->rows.size(); ++k) {
    auto& cells = read->rows[k];
    if (cells[names].empty())
      return fail(table.source, "line " + std::to_string(read->lines[k]) + " names no case; correct it");
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
