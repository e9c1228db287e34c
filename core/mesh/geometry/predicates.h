#pragma once

#include "core/base/numbers/geometry.h"

namespace homolog {

/// Sign (−1, 0, 1) of det(b − a, c − a, d − a), exactly: 1 where d lies on the side of the plane abc from which a, b, c
/// run counter-clockwise. Floating point decides where its error bound allows it, expansions elsewhere
/// [Shewchuk 1997, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates].
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The same in the plane: sign of det(b − a, c − a); 1 where a, b, c run counter-clockwise.
int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

}  // namespace homolog
