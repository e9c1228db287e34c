#pragma once

#include <algorithm>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/case/action.h"

namespace homolog {

/// Stiffness factors and regions after a dab of the brush.
struct Painted {
  std::shared_ptr<const VertexScalars> stiffness;
  std::shared_ptr<const Regions> regions;
  int touched = 0;  ///< vertices
};

// What update() does with the actions that paint; each refuses values out of range and regions that are not there.
Result<Painted> painted(const Document& document, const PaintStiffness& action);
Result<Painted> painted(const Document& document, const SmoothStiffness& action);
Result<Painted> painted(const Document& document, const PaintRegion& action);
Result<Painted> painted(const Document& document, const FillRegion& action);
Result<Painted> painted(const Document& document, const SetRegion& action);
Result<Painted> painted(const Document& document, const RenameRegion& action);
Result<Painted> painted(const Document& document, const RemoveRegion& action);
Result<Painted> painted(const Document& document, const SetStiffnessFactors& action);

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

}  // namespace homolog
