#pragma once

#include <string_view>

namespace homolog {

/// The meaning of a line of a case for its history, told from its keys alone. Values are not read, so a long case is
/// scanned in the time that it takes to read it.
struct LineKind {
  enum Kind { empty, step, look, note, undo, redo, checkpoint, unknown } kind = unknown;
  bool joined = false;  ///< a step that is undone and done again together with the one before
  bool stroke = false;  ///< a step that moves the mesh by hand
  bool keeps = false;   ///< a note that says more than its text [history_marks.h]
};

/// Returns what a line, given without its line feed, means: `unknown` where it is no JSON object, or none that is
/// spelled plainly.
LineKind kind_of(std::string_view line);

}  // namespace homolog
