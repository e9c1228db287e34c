#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "core/case/actions/kind.h"

namespace homolog {

/// Errors: no place, a radius or a share `soft` out of range.
inline Result<void> check_brush(const Vec3& at, double radius_mm, double soft) {
  if (at.allFinite() && std::isfinite(radius_mm) && radius_mm > 0 && soft >= 0 && soft <= 1) return {};
  return fail("brush", "needs a place, a radius above 0 mm and a soft edge between 0 and 1");
}

/// Applies `change(i, blend)` to the vertices within `radius_mm` of `at`; blend falls from 1 to 0 over the outer share
/// `soft` of the radius. Returns how many there were.
template <class Change>
int brush(const Points& points, const Vec3& at, double radius_mm, double soft, const Change& change) {
  int touched = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double distance = (points.row(i).transpose() - at).norm() / radius_mm;
    if (distance > 1) continue;
    const double edge = soft > 0 ? std::clamp((1 - distance) / soft, 0.0, 1.0) : 1;
    change(i, edge * edge * (3 - 2 * edge));
    ++touched;
  }
  return touched;
}

inline constexpr const char* nothing_covered = "No vertex lies within the circle; make the brush larger.";
/// The report after so many vertices were painted.
inline EditReport painted(std::ptrdiff_t vertices) {
  EditReport report;
  report.message = vertices > 0 ? std::to_string(vertices) + (vertices == 1 ? " vertex painted." : " vertices painted.")
                                : nothing_covered;
  return report;
}

}  // namespace homolog
