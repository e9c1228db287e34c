#include "core/phantom/ventricle_shape.h"

namespace homolog::phantom {
namespace {

constexpr double widest_height = 0.72;  ///< the cavity is half an ellipsoid below, and narrows a little above

/// The septum is flatter than the free wall.
double roundness(double x_share) {
  return x_share < 0 ? 1 - 0.09 * x_share * x_share : 1;
}

}  // namespace

double contraction(double time) {
  const double t = time - std::floor(time);
  const double ejected = smooth_step(0, 0.38, t);
  const double refilled = 0.72 * smooth_step(0.40, 0.68, t) + 0.28 * smooth_step(0.80, 1, t);
  return ejected - refilled;
}

double profile(double height) {
  const double below = (height - widest_height) / widest_height;
  return std::sqrt(std::max(0.0, 1 - below * below));
}

BeatingVentricle::BeatingVentricle(const Dimensions& dimensions, double time) {
  const double c = contraction(time);
  const double stretch = 1 - dimensions.longitudinal * c;
  length_mm_ = dimensions.length_mm * stretch;
  radius_mm_ = dimensions.radius_mm * (1 - dimensions.radial * c);
  twist_rad_ = dimensions.twist_rad * c;
  // Muscle keeps its volume: the wall's cross-section grows as it shortens.
  const double outer_mm = dimensions.radius_mm + dimensions.wall_mm;
  const double wall_area = (outer_mm * outer_mm - dimensions.radius_mm * dimensions.radius_mm) / stretch;
  wall_mm_ = std::sqrt(radius_mm_ * radius_mm_ + wall_area) - radius_mm_;
}

double BeatingVentricle::from_endocardium(const Vec3& p) const {
  const double across = std::hypot(p.x(), p.y());
  const double round = across > 0 ? roundness(p.x() / across) : 1;
  return ellipsoid(Vec3(p.x(), p.y(), p.z() - widest_height * length_mm_),
                   Vec3(radius_mm_ * round, radius_mm_ * round, widest_height * length_mm_));
}

Vec3 BeatingVentricle::endocardium(double height, double angle) const {
  const double turned = angle + twist_rad_ * (0.25 - height);
  const double radius = radius_mm_ * profile(height) * roundness(std::cos(turned));
  return {radius * std::cos(turned), radius * std::sin(turned), height * length_mm_};
}

}  // namespace homolog::phantom
