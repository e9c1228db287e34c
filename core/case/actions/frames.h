#pragma once

#include "core/case/actions/kind.h"

namespace homolog {

/// Shows a frame; one that has no shape yet gets the template at the last frame's placement. To look is no step of the
/// history: there is nothing to undo, and what can be redone stays so.
struct SetFrame {
  int frame = 0;
  bool step = false;  ///< it is a step, as in older files
  bool operator==(const SetFrame&) const = default;
};
const ActionKind<SetFrame>& action_kind(const SetFrame&);

/// Gives the shown frame a copy of another frame's shape.
struct StartFrameFrom {
  int frame = 0;
  bool operator==(const StartFrameFrom&) const = default;
};
const ActionKind<StartFrameFrom>& action_kind(const StartFrameFrom&);

}  // namespace homolog
