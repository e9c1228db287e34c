#pragma once

#include <algorithm>

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The place on the segment from `a` to `b` of the point nearest to `p`: 0 at `a`, 1 at `b`; 0 where both are one
/// point. Plain vectors of one length, in the plane or in space.
template <class Vector>
double nearest_on_segment(const Vector& p, const Vector& a, const Vector& b) {
  const double length2 = (b - a).squaredNorm();
  return length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
}

}  // namespace homolog
