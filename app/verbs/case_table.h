#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// A row of a table of cases, by column. The columns are called as `study make` calls them.
using RowOfCase = std::map<std::string, std::string>;

/// The columns that name files.
inline constexpr std::array<const char*, 3> file_columns{"file", "image", "labels"};

/// Whether a file is called as such tables are (.csv).
bool is_case_table(const std::filesystem::path& file);

/// A table with commas, semicolons or tabs between its cells. Errors: no rows, a line of another length, a column
/// twice.
Result<std::vector<RowOfCase>> read_case_table(const std::filesystem::path& path);

/// Whether a column is not a covariate.
bool is_own_column(const std::string& column);

/// Empty where the row has nothing there.
std::string cell_of(const RowOfCase& row, const char* column);
/// The name that a row says, else the name of its shape, its image or its label map.
std::string name_of_row(const RowOfCase& row);

/// A file that a table of cases names.
struct FileOfTable {
  std::string of_case;  ///< the name of its row
  std::string file;     ///< the file's name as the table spells it
};
/// All that it names, row by row; nothing of a table that cannot be read.
std::vector<FileOfTable> files_of_table(const std::filesystem::path& table);

}  // namespace homolog
