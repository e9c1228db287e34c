#pragma once

#include "core/case/actions/kind.h"

namespace homolog {

/// Turns the template into that of the other side (same numbering); the shapes start anew.
struct MirrorTemplate {
  /// Each mesh is mirrored where it lies: its centroid stays. Landmarks that place it go before. Without this, as in
  /// lines of older case files, the placement stays, which throws a template out of the scan whose own frame does not
  /// begin in its middle.
  bool keeps_centre = true;
  bool operator==(const MirrorTemplate&) const = default;
};
const ActionKind<MirrorTemplate>& action_kind(const MirrorTemplate&);

}  // namespace homolog
