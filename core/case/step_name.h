#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/case/action.h"

namespace homolog {

// What lists of the history call a step. A step may join several edits. It bears the name of its deed: its first edit
// that is no aside, so that undo and redo call it the same. A step of asides alone bears the name of its first, but
// where all of them rename structures level by level it is called by that.

/// What an edit is called.
struct EditName {
  std::string words;  ///< as edit_words has them, with the names of structures; empty where it was not read yet
  /// It only goes with the deed of its step: it describes, adds, removes or places a structure, or is the mesh that a
  /// propagation through a cine starts from.
  bool aside = false;
  bool renames = false;  ///< it gives a structure that is there another name
  /// Of an edit that renames a structure by a number alone: how much higher the number is ("L3" to "L4": 1).
  std::optional<int> levels;
};

/// `before`: the document that the edit begins with.
EditName edit_name(const EditStep& step, const Document& before);
/// Whether edit_name needs the very state before the edit: it gives a structure a name. For other edits another state
/// of the case will do.
bool is_renaming(const Action& action);
/// The name of the step that joins these edits, in their order: at least one. Those after the first that is no aside
/// may be left out.
std::string step_name(std::span<const EditName> edits);

}  // namespace homolog
