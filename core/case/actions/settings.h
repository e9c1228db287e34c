#pragma once

#include "core/case/actions/kind.h"

namespace homolog {

/// How the strokes after it move the mesh.
struct SetScheme {
  Scheme scheme = Scheme::anchored;
  int paper_events = 1;
  bool operator==(const SetScheme&) const = default;
};
const ActionKind<SetScheme>& action_kind(const SetScheme&);

/// How strongly the strokes after it keep vertices evenly spread, 0…1.
struct SetEvenSpacing {
  double strength = 0;
  bool operator==(const SetEvenSpacing&) const = default;
};
const ActionKind<SetEvenSpacing>& action_kind(const SetEvenSpacing&);

}  // namespace homolog
