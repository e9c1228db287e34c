#pragma once

#include <filesystem>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// The shapes of a folder by name: its meshes of the formats that keep vertices, and its case files. If a mesh and a
/// case have one name, one of them is taken: the case where somebody worked on it since its fit, else the mesh, which
/// is read faster. The file that a case was imported from is no further shape, nor are ShapeWorks' NAME_world.particles
/// beside NAME_local.particles. Errors: none there, no folder.
Result<std::vector<std::filesystem::path>> shapes_in_folder(const std::filesystem::path& folder);

/// Whether a case file goes on after the note of its fit. False where it has none.
bool goes_on_after_fit(const std::filesystem::path& case_file);

/// Whether somebody worked on a case that may not be made anew: it goes on after the note of its fit, or has edits and
/// no such note.
bool was_worked_on(const std::filesystem::path& case_file);

}  // namespace homolog
