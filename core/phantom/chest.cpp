#include "core/phantom/chest.h"

#include "core/phantom/noise.h"

namespace homolog::phantom {
namespace {

constexpr double blood = 300, heart_muscle = 98, fat = 215, lung = 22;

}  // namespace

double chest(const Vec3& p, double blur_mm, std::uint64_t seed) {
  const double coarse = smooth_noise(p / 15, seed), fine = smooth_noise(p / 5, seed + 1);
  Voxel voxel{lung + 10 * fine, blur_mm};
  const double vessel = std::hypot(smooth_noise(p / 21, seed + 3), smooth_noise(p / 21, seed + 4));
  voxel.paint(21 * vessel - 1.6, 150);  // the zero lines of two fields branch like the lung's vessels
  voxel.paint(ellipsoid(p - Vec3(-70, -5, -122), Vec3(125, 92, 74)), 142 + 10 * coarse);             // liver
  voxel.paint(ellipsoid(p - Vec3(62, 18, -112), Vec3(48, 52, 56)) + 4 * coarse, 120 + 90 * coarse);  // stomach
  const double skin = elliptic_cylinder(p.x() + 50, p.y() - 15, 172, 104);
  voxel.paint(-26 - skin, 82 + 12 * fine);
  for (int k = 0; k < 5; ++k) {
    const double level = -76 + 38 * k;
    const double rib = elliptic_cylinder(skin + 21, p.z() - level - 0.25 * p.x() + 0.4 * p.y(), 4, 7);
    voxel.paint(rib, 30);
    voxel.paint(rib + 1.2, 125);
  }
  voxel.paint(-14 - skin, fat + 30 + 25 * fine);
  voxel.paint(-2 - skin, 90);
  voxel.paint(-skin, 4);
  const double column = elliptic_cylinder(p.x() + 52, p.y() - 88, 23, 18);
  voxel.paint(column - 18, 85 + 12 * fine);
  voxel.paint(column, 128 + 12 * fine);
  voxel.paint(elliptic_cylinder(p.x() + 22, p.y() - 70, 12, 12), blood - 20);  // descending aorta
  return voxel.value;
}

Heart::Heart(const BeatingVentricle::Dimensions& dimensions, double time)
    : ventricle_(dimensions, time),
      shrink_(1 - 0.7 * dimensions.radial * contraction(time)),
      swell_(1 + 0.12 * contraction(time)),
      base_mm_(ventricle_.base_mm()) {
  const auto inside = [&](double height, double angle, double share) {
    const Vec3 q = ventricle_.endocardium(height, angle);
    return Vec3(share * q.x(), share * q.y(), q.z());
  };
  papillary_ends_ = {inside(0.26, -0.75, 0.80), inside(0.64, -0.75, 0.60), inside(0.26, 1.95, 0.80),
                     inside(0.62, 1.95, 0.60)};
}

bool Heart::beyond(const Vec3& q) {
  return (q - Vec3(-18, 4, 58)).cwiseQuotient(Vec3(66, 58, 80)).squaredNorm() > 1;
}

double Heart::paint(double around, const Vec3& q, double mottle, double blur_mm) const {
  Voxel voxel{around, blur_mm};
  const double endocardium = ventricle_.from_endocardium(q);
  const double left = smooth_max(endocardium - ventricle_.wall_mm(), q.z() - base_mm_, 3);
  const double right =
      ellipsoid(q - Vec3(-31 * shrink_, 1, 0.60 * base_mm_), Vec3(31 * shrink_, 41 * shrink_, 0.56 * base_mm_));
  const double atrium = ellipsoid(q - Vec3(12, 12, base_mm_ + 20), Vec3(27, 25, 22) * swell_);
  const double right_atrium = ellipsoid(q - Vec3(-50, 18, base_mm_ + 12), Vec3(22, 26, 24) * swell_);
  const double outflow = round_cone(q, {-10, -6, base_mm_ - 6}, {-26, -14, base_mm_ + 40}, 11, 13);
  const double thin_walled = std::min({right - 1.8, atrium - 2, right_atrium - 2, outflow - 1.5});

  const double outside = smooth_min(left, thin_walled, 8);
  const double fat_mm = 3 + 5 * mottle;
  voxel.paint(outside - fat_mm - 1.4, heart_muscle - 40);  // pericardium
  voxel.paint(outside - fat_mm, fat);
  voxel.paint(smooth_min(left, thin_walled, 2), heart_muscle);
  voxel.paint(std::min({right, atrium, right_atrium, outflow}), blood - 12);
  voxel.paint(left, heart_muscle);
  voxel.paint(smooth_max(endocardium, q.z() - base_mm_, 1), blood);
  if (endocardium < 0 && q.z() < base_mm_) {
    const auto& [a0, a1, b0, b1] = papillary_ends_;
    voxel.paint(std::min(round_cone(q, a0, a1, 5.2, 4.2), round_cone(q, b0, b1, 5.4, 4.2)), heart_muscle + 35);
  }
  return voxel.value;
}

bool Heart::in_myocardium(const Vec3& q) const {
  const double d = ventricle_.from_endocardium(q);
  return d >= 0 && d < ventricle_.wall_mm() && q.z() < base_mm_;
}

}  // namespace homolog::phantom
