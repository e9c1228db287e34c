#pragma once

#include <optional>

#include "core/mesh/geometry/surface_search.h"

namespace homolog {

/// A reflection of space, LPS mm.
struct Reflection {
  Mat3 turn = Mat3::Identity();  ///< its determinant is −1
  Vec3 shift = Vec3::Zero();
  Vec3 apply(const Vec3& p) const { return turn * p + shift; }
};

/// The reflection across the sagittal plane through the middle of these points (n×3).
Reflection sagittal_reflection(const Points& points);

/// The reflection in the space that a similarity leads to.
Reflection carried_by(const Similarity& similarity, const Reflection& reflection);

/// The reflection that carries a surface nearly onto itself, as that of a vertebra does, whose left side looks like its
/// right one. Found by closest points from the reflection `start`. None where the reflected surface stays off itself by
/// more than 1.5 % of the root of its area (root mean square): the vertebrae that were measured lie at 0.6 to 1.2 %,
/// kidneys, femora and hip bones at 1.9 % or more.
std::optional<Reflection> mirror_symmetry(const SurfaceSearch& surface, const Reflection& start);

}  // namespace homolog
