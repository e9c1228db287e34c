#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/numbers/geometry.h"

/// Solids as functions of a point: about the distance to the surface in mm, negative inside. Near the surface the
/// gradient's length is near 1, farther away only the sign is right.
namespace homolog::phantom {

/// Rises from 0 at `low` to 1 at `high`, level at both.
inline double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// The smaller of two, rounded over a range of `k` mm.
inline double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}
inline double smooth_max(double a, double b, double k) {
  return -smooth_min(-a, -b, k);
}

/// Ellipsoid around the origin with the given semi-axes.
inline double ellipsoid(const Vec3& p, const Vec3& axes) {
  const Vec3 q = p.cwiseQuotient(axes);
  const double steepness = q.cwiseQuotient(axes).norm();
  const double radius = q.norm();
  return steepness > 1e-12 ? radius * (radius - 1) / steepness : -axes.minCoeff();
}

/// Cylinder of elliptic cross-section along z.
inline double elliptic_cylinder(double x, double y, double axis_x, double axis_y) {
  return ellipsoid(Vec3(x, y, 0), Vec3(axis_x, axis_y, 1));
}

/// Cone with rounded ends: radius changes from `radius_a` at `a` to `radius_b` at `b`.
inline double round_cone(const Vec3& p, const Vec3& a, const Vec3& b, double radius_a, double radius_b) {
  const Vec3 axis = b - a;
  const double t = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - a - t * axis).norm() - (radius_a + t * (radius_b - radius_a));
}

/// Box around the origin with half sizes `half`, its edges rounded by `radius` (within the half sizes).
inline double round_box(const Vec3& p, const Vec3& half, double radius) {
  const Vec3 q = p.cwiseAbs() - half + Vec3::Constant(radius);
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0) - radius;
}

/// How much of a voxel `blur_mm` wide lies inside a surface at distance `d`: 0…1 (partial volume).
inline double covered(double d, double blur_mm) {
  return smooth_step(-0.5, 0.5, -d / blur_mm);
}

/// The value of one voxel, painted tissue over tissue from back to front.
struct Voxel {
  double value;
  double blur_mm;
  void paint(double d, double tissue) {
    if (d < blur_mm / 2) value += (tissue - value) * covered(d, blur_mm);
  }
};

}  // namespace homolog::phantom
