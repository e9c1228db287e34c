#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/work/exports.h"
#include "core/phantom/phantom.h"

namespace homolog {

/// What the editor opens with; with nothing it offers what was not saved, else shows the demo case.
struct EditorOptions {
  std::vector<std::filesystem::path> files;  ///< a case, an image, a template
  std::string template_source;               ///< path, or a built-in template's name; empty without one
  std::optional<Organ> demo;                 ///< a phantom's image with its template
  std::filesystem::path log;                 ///< gets every command as a line; empty: none does
  std::filesystem::path replay;              ///< such a file, whose commands are done again; empty: none
  WriteReport write_report;                  ///< for the button; empty: there is none
};

/// The editor in a window, until it is closed. Returns the program's exit status; without a display it says so on
/// stderr and returns 1.
int run_editor(const EditorOptions& options);

}  // namespace homolog
