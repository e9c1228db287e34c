#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/model/alignment/procrustes.h"
#include "core/phantom/phantom.h"

// The things that the command line and the editor know of each other.

namespace homolog {

/// Writes the page of a study's model, as `homolog report` does: of the study's file, to `out`. `the_template`: its
/// source, where it has a recipe to measure by; else empty. Gives warnings.
using WriteReport = std::function<Result<std::vector<std::string>>(const std::filesystem::path& study,
                                                                   Alignment alignment, const std::string& the_template,
                                                                   const std::filesystem::path& out, Progress&)>;

/// The files and options that the editor opens with; with nothing it offers what was not saved, else shows the demo
/// case.
struct EditorOptions {
  std::vector<std::filesystem::path> files;  ///< a case, an image, a template
  std::string template_source;               ///< path, or a built-in template's name; empty without one
  std::optional<Organ> demo;                 ///< a phantom's image with its template
  std::filesystem::path log;                 ///< gets every command as a line; empty: none does
  std::filesystem::path replay;              ///< such a file, whose commands are done again; empty: none
  WriteReport write_report;                  ///< writes the report for the button; empty: there is none
};

}  // namespace homolog
