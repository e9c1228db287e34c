#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace homolog {

/// The files that a file names, as it spells them, in its order: a case its image and its templates, a study its
/// shapes, a template set its templates, a header its voxels, a table of cases (.csv) what `study make` reads of it.
/// Built-in names are left out.
std::vector<std::string> files_named_in(const std::filesystem::path& file);

}  // namespace homolog
