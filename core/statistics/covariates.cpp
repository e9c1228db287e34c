#include "core/statistics/covariates.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "core/base/text/text.h"
#include "core/base/text/text_table.h"

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

Result<CovariateTable> read_covariates(const std::filesystem::path& path) {
  auto read = read_text_table(path);
  if (!read) return fail(read.error());
  if (auto mended = mend_decimal_commas(path, *read); !mended) return fail(mended.error());
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
