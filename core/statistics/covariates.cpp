#include "core/statistics/covariates.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "core/base/text/text.h"
#include "core/base/text/text_table.h"

namespace homolog {

namespace {

/// None: no column is called so.
std::optional<std::size_t> column_of_names(const std::vector<std::string>& columns) {
  for (const char* word : {"name", "case", "id"})
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (lower_case(columns[k]) == word) return k;
  return std::nullopt;
}

/// Whether a row is one that `measure --model` wrote: a mode of the model and no case.
bool is_row_of_model(const std::vector<std::string>& columns, const std::vector<std::string>& cells,
                     const std::string& name) {
  if (name != "model") return false;
  return std::ranges::all_of(std::array{"mode", "sd"}, [&](const char* word) {
    const auto column = std::find(columns.begin(), columns.end(), word);
    return column != columns.end() && as_number<double>(cells[column - columns.begin()]);
  });
}

Result<void> refuse_twice(const std::string& source, const char* what, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) return fail(source, std::string("has the ") + what + " " + name + " twice");
  return {};
}

/// "1." of "1", "1.0" and "01": the digits without those that say nothing. Nothing of other text.
std::optional<std::string> bare_digits(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  std::string_view whole = text.substr(0, point), rest = text.substr(std::min(point + 1, text.size()));
  if (whole.size() + rest.size() == 0) return std::nullopt;
  for (const std::string_view part : {whole, rest})
    if (part.find_first_not_of("0123456789") != part.npos) return std::nullopt;
  while (whole.starts_with('0')) whole.remove_prefix(1);
  while (rest.ends_with('0')) rest.remove_suffix(1);
  const std::string digits = std::string(whole) + "." + std::string(rest);
  return negative && digits != "." ? "-" + digits : digits;
}

}  // namespace

void write_numbers_alike(CovariateTable& table, std::size_t column) {
  std::map<std::string, std::string> shortest;  // by the bare digits
  for (const auto& row : table.cells) {
    const std::string& cell = row[column];
    if (is_missing(cell)) continue;
    const auto digits = bare_digits(cell);
    if (!digits && !as_number<double>(cell)) return;
    if (!digits) continue;
    std::string& known = shortest.emplace(*digits, cell).first->second;
    if (cell.size() < known.size()) known = cell;
  }
  for (auto& row : table.cells)
    if (const auto digits = bare_digits(row[column]); digits && !is_missing(row[column]))
      row[column] = shortest.at(*digits);
}

std::optional<std::size_t> CovariateTable::column(std::string_view name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

Result<CovariateTable> read_covariates(const std::filesystem::path& path) {
  auto read = read_text_table(path);
  if (!read) return fail(read.error());
  const std::string encoding = mend_encoding(*read);
  if (auto mended = mend_decimal_commas(path, *read); !mended) return fail(mended.error());
  CovariateTable table{path.string(), std::move(read->columns), {}, {}};
  if (!encoding.empty()) table.warnings.push_back(table.source + ": " + encoding);
  const auto called = column_of_names(table.columns);
  const std::size_t names = called.value_or(0);
  if (!called && !table.columns.empty()) table.first_as_names = table.columns.front();
  for (std::size_t k = 0; k < read->rows.size(); ++k) {
    auto& cells = read->rows[k];
    if (cells[names].empty())
      return fail(table.source, "line " + std::to_string(read->lines[k]) + " names no case; correct it");
    if (is_row_of_model(table.columns, cells, cells[names])) continue;
    table.cases.push_back(std::move(cells[names]));
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(names));
    table.cells.push_back(std::move(cells));
  }
  if (table.cases.empty()) return fail(table.source, "has no cases; give a line with the columns and one a case");
  table.columns.erase(table.columns.begin() + static_cast<std::ptrdiff_t>(names));
  if (auto once = refuse_twice(table.source, "column", table.columns); !once) return fail(once.error());
  if (auto once = refuse_twice(table.source, "case", table.cases); !once)
    return fail(table.source,
                once.error().what + (called ? ""
                                            : ": its names are in the first column, " + table.first_as_names +
                                                  ", since none is called name, case or id"));
  return table;
}

}  // namespace homolog
