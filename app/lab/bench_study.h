#pragma once

#include <filesystem>

#include "app/verbs/verb.h"

namespace homolog {

/// A study of so many phantom kidneys in a temporary folder, as meshes and as cases with their image: the time until
/// the Models mode shows it, its frames, and the memory. Errors: the folder cannot be written to, no OpenGL, cancelled.
Result<Json> study_figures(int shapes, Progress& progress);

/// The same of one study, which is there: the time until the Models mode shows it, its frames, and the memory. Errors:
/// no OpenGL.
Result<Json> figures_of_study(const std::filesystem::path& study);

}  // namespace homolog
