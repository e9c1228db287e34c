#include "core/phantom/deformation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/numbers/random.h"

namespace homolog::phantom {
namespace {

/// Two deviations at most: a subject is unusual, never grotesque.
double normal_within_two(Random& random) {
  return std::clamp(random.normal(), -2.0, 2.0);
}

/// A point at random in the shell of an ellipsoid, where a bump changes the organ's surface.
Vec3 near_surface(Random& random, const Vec3& half_size_mm) {
  Vec3 direction;
  do {
    for (int axis = 0; axis < 3; ++axis) direction[axis] = random.uniform(-1, 1);
  } while (direction.squaredNorm() > 1 || direction.squaredNorm() < 0.01);
  return direction.normalized().cwiseProduct(half_size_mm) * random.uniform(0.7, 1.1);
}

}  // namespace

Deformation::Deformation(int subject, std::uint64_t organ_seed, const Variation& variation) {
  if (subject == 0) return;
  Random random(mix_bits(organ_seed) + static_cast<std::uint64_t>(subject));

  const double log_size = variation.size * normal_within_two(random);
  Vec3 log_scale;
  for (int axis = 0; axis < 3; ++axis) log_scale[axis] = log_size + variation.elongation * normal_within_two(random);
  Vec3 turn_rad;
  for (int axis = 0; axis < 3; ++axis) {
    turn_rad[axis] = variation.rotation_deg * std::numbers::pi / 180 * normal_within_two(random);
    shift_mm_[axis] = variation.shift_mm * normal_within_two(random);
  }
  const double angle = turn_rad.norm();
  const Mat3 rotation = Eigen::AngleAxisd(angle, angle > 0 ? Vec3(turn_rad / angle) : Vec3::UnitX()).matrix();
  linear_ = rotation * log_scale.array().exp().matrix().asDiagonal();
  linear_inverse_ = (-log_scale).array().exp().matrix().asDiagonal() * rotation.transpose();

  const double reach_mm = variation.half_size_mm.maxCoeff();
  for (int along = 0; along < 3; ++along) {
    const int a = (along + 1) % 3, b = (along + 2) % 3;
    for (const auto& [first, second] : {std::pair(a, a), std::pair(b, b), std::pair(a, b)}) {
      const double end_mm2 = variation.half_size_mm[first] * variation.half_size_mm[second];
      shears_.push_back({along, first, second, variation.bend_mm * normal_within_two(random) / end_mm2, reach_mm});
    }
  }
  for (int i = 0; i < variation.bumps; ++i) {
    const Vec3 centre = near_surface(random, variation.half_size_mm);
    const double radius_mm = variation.bump_radius_mm * random.uniform(0.7, 1.3);
    Vec3 offset;
    for (int axis = 0; axis < 3; ++axis) offset[axis] = variation.bump_mm / std::sqrt(3.0) * normal_within_two(random);
    bumps_.push_back({centre, offset, radius_mm});
  }
}

double Deformation::Shear::displacement(const Vec3& p) const {
  const double u = p[first], v = p[second];
  return per_mm * u * v / (1 + (u * u + v * v) / (2 * reach_mm * reach_mm));
}

Vec3 Deformation::Bump::apply(const Vec3& p) const {
  const double s = (p - centre).squaredNorm() / (radius_mm * radius_mm);
  if (s >= 1) return p;
  const double rest = 1 - s;
  return p + rest * rest * rest * offset;
}

Vec3 Deformation::Bump::invert(const Vec3& q) const {
  Vec3 p = q;
  for (int round = 0; round < 200; ++round) {
    const Vec3 error = apply(p) - q;
    p -= error;
    if (error.squaredNorm() < 1e-24) break;
  }
  return p;
}

Vec3 Deformation::to_mean(const Vec3& p) const {
  Vec3 x = linear_inverse_ * (p - shift_mm_);
  for (const Shear& shear : shears_) x[shear.along] -= shear.displacement(x);
  for (const Bump& bump : bumps_) x = bump.apply(x);
  return x;
}

Vec3 Deformation::to_subject(const Vec3& x) const {
  Vec3 p = x;
  for (auto bump = bumps_.rbegin(); bump != bumps_.rend(); ++bump) p = bump->invert(p);
  for (auto shear = shears_.rbegin(); shear != shears_.rend(); ++shear) p[shear->along] += shear->displacement(p);
  return linear_ * p + shift_mm_;
}

Points Deformation::to_subject(const Points& points) const {
  Points moved(points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) moved.row(i) = to_subject(Vec3(points.row(i))).transpose();
  return moved;
}

}  // namespace homolog::phantom
