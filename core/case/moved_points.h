#pragma once

#include <cmath>
#include <optional>

#include "core/case/actions/points.h"

namespace homolog {

// Computed edits (a fit, a snap, a refinement, a model's help) put vertices on a grid of this step: fine beyond
// anything an image shows, and few bits, so that a case can hold thousands of them. They are rounded when they are
// made, so that what is shown, what is in the file and what the file replays to are the same to the last bit.
inline constexpr double steps_per_mm = 65536;  // 2¹⁶

/// A coordinate (mm) rounded to the grid.
inline double on_grid(double mm) {
  return std::nearbyint(mm * steps_per_mm) / steps_per_mm;
}

/// An edit as a case keeps it, for a shape that was at `before` (n×3): none where a coordinate that changes is not on
/// the grid, or lies 8 m and more from the origin.
std::optional<MovePoints> moves_of(const Points& before, const SetPoints& edit);

/// The edit that `moves_of` made `edit` of, to the last bit; `before` may be off by half a step. Errors: moves of
/// another number of vertices.
Result<SetPoints> points_of(const Points& before, const MovePoints& edit);

}  // namespace homolog
