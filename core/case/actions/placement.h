#pragma once

#include "core/case/actions/kind.h"

namespace homolog {

/// Moves the shown mesh and its reference to another placement of the template.
struct SetPlacement {
  Similarity placement;
  bool operator==(const SetPlacement&) const = default;
};
const ActionKind<SetPlacement>& action_kind(const SetPlacement&);

}  // namespace homolog
