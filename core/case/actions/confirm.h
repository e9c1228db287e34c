#pragma once

#include "core/case/actions/kind.h"

namespace homolog {

/// Holds (or frees) the vertices within `radius_mm` of `at`: later strokes leave held ones where they are.
struct Confirm {
  Vec3 at = Vec3::Zero();
  double radius_mm = 10;
  bool hold = true;
  bool operator==(const Confirm&) const = default;
};
const ActionKind<Confirm>& action_kind(const Confirm&);

}  // namespace homolog
