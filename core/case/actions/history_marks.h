#pragma once

#include <string>

#include "core/case/actions/kind.h"

namespace homolog {

// Lines that change no mesh.

struct Note {
  std::string text;
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
