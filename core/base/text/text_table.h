#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// A table as text: a line with the columns, then a line a row. Blank lines are left out.
struct TextTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< each holds one cell a column, trimmed
  std::vector<std::size_t> lines;              ///< the line of the file at which each row stands, from 1
  char separator = ',';                        ///< between cells
};

/// Reads a table with commas, semicolons or tabs between its cells [table_separator]. A first line "sep=;" says which,
/// lines may end as those of old Macs, and the row numbers that R's write.table puts before rows without a column are
/// left out. Errors: unreadable, UTF-16, more than 32 MiB, a line with another number of cells than columns.
Result<TextTable> read_text_table(const std::filesystem::path& path);

/// Reads what is no UTF-8 as Windows-1252, which spreadsheets write. Gives what a warning says of that; empty: all was
/// UTF-8.
std::string mend_encoding(TextTable& table);

/// Whether a cell holds no value: it is empty, or says "NA", "NaN", "." or "?".
bool is_missing(std::string_view cell);

/// Writes "0,5" as "0.5" in the columns that hold numbers alone: where cells are not parted by commas, spreadsheets of
/// many countries write numbers so. `of_text`: columns that hold text whatever it looks like. Errors: a column that has
/// points too, or whose commas may all part thousands ("1,234").
Result<void> mend_decimal_commas(const std::filesystem::path& path, TextTable& table,
                                 const std::function<bool(const std::string& column)>& of_text = {});

}  // namespace homolog
