#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/case/actions/kind.h"

namespace homolog {

// Lines that change no mesh.

/// A remark; it may say how the case is shown and what becomes of it, which no undo takes back.
struct Note {
  std::string text;
  std::optional<std::array<double, 2>> window;  ///< the image's values that are shown black and white
  std::string template_file;                    ///< where the template was saved as it is painted; empty: it was not
  /// Whether it says more than its text.
  bool keeps() const { return window || !template_file.empty(); }
  bool operator==(const Note&) const = default;
};
const ActionKind<Note>& action_kind(const Note&);

struct Undo {
  bool operator==(const Undo&) const = default;
};
const ActionKind<Undo>& action_kind(const Undo&);

struct Redo {
  bool operator==(const Redo&) const = default;
};
const ActionKind<Redo>& action_kind(const Redo&);

}  // namespace homolog
