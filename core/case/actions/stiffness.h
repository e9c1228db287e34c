#pragma once

#include "core/base/same_values.h"
#include "core/case/actions/kind.h"

namespace homolog {

/// Sets w to `value` within `radius_mm` of `at`; over the outer share `soft` of the radius it blends with what was
/// there.
struct PaintStiffness {
  Vec3 at = Vec3::Zero();
  double radius_mm = 10, value = 10, soft = 0;
  bool operator==(const PaintStiffness&) const = default;
};
const ActionKind<PaintStiffness>& action_kind(const PaintStiffness&);

/// Draws each factor within `radius_mm` towards the mean of its one-ring; the edge of the brush is soft.
struct SmoothStiffness {
  Vec3 at = Vec3::Zero();
  double radius_mm = 10, strength = 0.5;
  bool operator==(const SmoothStiffness&) const = default;
};
const ActionKind<SmoothStiffness>& action_kind(const SmoothStiffness&);

/// Gives every vertex a factor, from an array of a mesh file.
struct SetStiffnessFactors {
  SharedValue<VertexScalars> factors;
  bool operator==(const SetStiffnessFactors&) const = default;
};
const ActionKind<SetStiffnessFactors>& action_kind(const SetStiffnessFactors&);

struct SetStiffnessBase {
  double base = default_stiffness_base;
  bool operator==(const SetStiffnessBase&) const = default;
};
const ActionKind<SetStiffnessBase>& action_kind(const SetStiffnessBase&);

}  // namespace homolog
