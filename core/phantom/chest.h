#pragma once

#include <array>

#include "core/phantom/ventricle_shape.h"

// The chest around the ventricle as balanced steady-state MR shows it: bright blood and fat, dark muscle, black lungs.
namespace homolog::phantom {

/// The intensity of what lies around the heart and stands still, at `p` (LPS mm, origin in the ventricle).
double chest(const Vec3& p, double blur_mm, std::uint64_t seed);

/// The heart at one moment. Points `q` are in the ventricle's frame (ventricle_shape.h).
class Heart {
 public:
  Heart(const BeatingVentricle::Dimensions& dimensions, double time);

  /// True where no part of the heart is ever painted.
  static bool beyond(const Vec3& q);
  /// The image's value, where `around` is what the chest shows; `mottle` (about −1…1) varies the fat's thickness.
  double paint(double around, const Vec3& q, double mottle, double blur_mm) const;
  bool in_myocardium(const Vec3& q) const;

 private:
  BeatingVentricle ventricle_;
  double shrink_, swell_, base_mm_;
  std::array<Vec3, 4> papillary_ends_;
};

}  // namespace homolog::phantom
