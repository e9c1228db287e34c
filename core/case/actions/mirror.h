#pragma once

#include "core/case/actions/kind.h"

namespace homolog {

/// Turns the template into that of the other side (same numbering); the shape starts anew at its placement.
struct MirrorTemplate {
  bool operator==(const MirrorTemplate&) const = default;
};
const ActionKind<MirrorTemplate>& action_kind(const MirrorTemplate&);

}  // namespace homolog
