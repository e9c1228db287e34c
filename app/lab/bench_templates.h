#pragma once

#include <filesystem>
#include <vector>

#include "app/verbs/verb.h"

namespace homolog {

/// A template of every label of every mask, with default settings: quality, distances in mm and milliseconds,
/// one row each, and the worst of all. A mask that cannot be read has its sentence in the row.
Json template_figures(const std::vector<std::filesystem::path>& masks, int vertices, Progress& progress);

}  // namespace homolog
