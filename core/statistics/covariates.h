#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// Facts about cases beside their shape, as text: a row a case.
struct CovariateTable {
  std::string source;                           ///< the file, as errors name it
  std::vector<std::string> columns;             ///< all columns but that of the names
  std::vector<std::string> cases;               ///< names; no two are equal
  std::vector<std::vector<std::string>> cells;  ///< each case's cells, one a column
  std::string first_as_names{};  ///< the first column, where it has the names because none is called so; else empty
  std::vector<std::string> warnings{};  ///< each a sentence

  /// The column of that name, from 0.
  std::optional<std::size_t> column(std::string_view name) const;
};

/// Writes numbers of one value alike, as 1, 1.0 and 01, in a column that holds numbers alone: as the shortest of them.
/// Numbers with an exponent stay as they are.
void write_numbers_alike(CovariateTable& table, std::size_t column);

/// Reads a table with commas, semicolons or tabs. The names are in the column name, case or id, else in the first.
/// The rows of a model's modes, which `measure --model` writes, are left out.
/// Errors: unreadable, no rows, a line with another number of cells, a column or a case twice, a row without a name.
Result<CovariateTable> read_covariates(const std::filesystem::path& path);

}  // namespace homolog
