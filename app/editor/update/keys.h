#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/key_codes.h"
#include "app/editor/update/controls.h"

namespace homolog {

/// A key with what is held.
struct KeyChord {
  int code = 0;
  bool ctrl = false, shift = false;
};

/// The things that a command may be made of when a key is pressed.
struct KeyMoment {
  const EditorState& state;
  const ControlsContext& context;
  int code;
};

/// A key, or keys that belong together, of the case's views or the Models mode. The list that F1 shows is made of these
/// rows, and a test holds docs/editing.md to them. Keys of dialogs, and those that move the pointer and the keyboard's
/// focus, end before they come here (window/input_router.cpp, update/key_pointer.cpp).
struct KeyRow {
  const char* keys;  ///< as it is written: "Ctrl+Z"
  const char* does;
  std::vector<KeyChord> chords;
  /// None where the key does nothing at the moment.
  std::optional<Command> (*command)(const KeyMoment& now);
  bool in_drag = true;  ///< else it does nothing while the mouse drags: the drag would go on with something else
};

/// Returns the keys of the case's views, or of the Models mode.
const std::vector<KeyRow>& key_rows(bool in_models);

}  // namespace homolog
