#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/verbs/verb.h"

// Tables of `study schemes`. Rows are flat JSON objects.

namespace homolog {

/// One row for a scheme: means over its `runs` (rows with the names of json_of(SchemeRun)); of pulls the median, of the
/// smallest angle the least, of turned triangles the sum.
Json summary_of_runs(const std::string& scheme, const std::vector<Json>& runs);

/// The rows as CSV, a column for each name in any of them, in the order of first appearance. Whole or not at all.
Result<void> write_csv(const std::vector<Json>& rows, const std::filesystem::path& path);

/// The summary rows as a table in Markdown.
std::string markdown_table(const std::vector<Json>& rows);

}  // namespace homolog
