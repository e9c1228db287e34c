#pragma once

#include "core/phantom/implicit.h"

namespace homolog::phantom {

/// The left ventricle in its own frame: z along the long axis from the apex (0) towards the base, x to the lateral
/// wall, y to the inferior wall; angles from x towards y. One heartbeat is the unit of time, end-diastole is 0.
class BeatingVentricle {
 public:
  struct Dimensions {
    double length_mm = 90;    ///< apex to the base, end-diastole
    double radius_mm = 25.6;  ///< the cavity's radius where it is widest
    double wall_mm = 9;       ///< end-diastole
    double radial = 0.30;     ///< share of the radius lost at end-systole
    double longitudinal = 0.14;
    double twist_rad = 0.17;  ///< the apex's turn against the base at end-systole
  };

  BeatingVentricle(const Dimensions& dimensions, double time);

  /// About the distance from the endocardium in mm, negative in the cavity (which goes on above the base).
  double from_endocardium(const Vec3& p) const;
  double wall_mm() const { return wall_mm_; }
  double base_mm() const { return length_mm_; }
  /// The endocardial point that lies at share `height` (0 the apex, 1 the base) and `angle` at end-diastole.
  Vec3 endocardium(double height, double angle) const;

 private:
  double twist_rad_;
  double length_mm_, radius_mm_, wall_mm_;
};

/// 0 at end-diastole, 1 at end-systole: ejection, early filling, rest, atrial contraction. Period 1, smooth.
double contraction(double time);

/// Radius of the cavity at share `height` of its length, as a share of the widest.
double profile(double height);

}  // namespace homolog::phantom
