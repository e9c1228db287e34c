#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// A table as text: a line with the columns, then a line a row. Blank lines are left out.
struct TextTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< of each one cell a column, trimmed
  std::vector<std::size_t> lines;              ///< where in the file each row stands, from 1
  char separator = ',';                        ///< between cells
};

/// Reads a table with commas, semicolons or tabs between its cells [table_separator]. Errors: unreadable, more than
/// 32 MiB, a line with another number of cells than columns.
Result<TextTable> read_text_table(const std::filesystem::path& path);

/// "0,5" as "0.5": where cells are not parted by commas, spreadsheets of many countries write numbers so. Of other text
/// nothing.
std::optional<std::string> with_decimal_point(const std::string& cell);

}  // namespace homolog
