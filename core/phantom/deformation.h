#pragma once

#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog::phantom {

/// How far the subjects of an organ vary (one standard deviation), and where.
struct Variation {
  double size = 0.06;          ///< log scale of the whole
  double elongation = 0.05;    ///< log scale along each axis
  double bend_mm = 3;          ///< sideways, at the end of an axis
  double bump_mm = 3;          ///< displacement at the middle of a local bump
  double bump_radius_mm = 40;  ///< the radius at which a bump ends
  int bumps = 10;
  double rotation_deg = 3;
  double shift_mm = 2.5;
  Vec3 half_size_mm = Vec3::Constant(40);  ///< half the organ's size, around the origin of the mean shape
};

/// The smooth, invertible map between a subject's space and that of the mean shape: pose and scale, then shears that
/// bend and twist, then local bumps. Every step is a diffeomorphism of space, so no surface folds under it.
class Deformation {
 public:
  /// Subject 0 is the identity; any other number its own map.
  Deformation(int subject, std::uint64_t organ_seed, const Variation& variation);

  /// The place of a subject's point in the mean shape's space.
  Vec3 to_mean(const Vec3& p) const;
  /// The inverse, to 1e-10 mm.
  Vec3 to_subject(const Vec3& x) const;
  Points to_subject(const Points& points) const;

 private:
  /// Moves points along one axis by a function of the two others, hence invertible in closed form.
  struct Shear {
    int along, first, second;  ///< displacement along `along` ∝ first · second (the same axis twice: a bend)
    double per_mm;             ///< curvature, 1/mm
    double reach_mm;           ///< beyond this distance the displacement levels off
    double displacement(const Vec3& p) const;
  };
  /// x ↦ x + offset · (1 − ‖x − centre‖² / radius²)³ within the radius; invertible as ‖offset‖ < 0.58 radius.
  struct Bump {
    Vec3 centre, offset;
    double radius_mm;
    Vec3 apply(const Vec3& p) const;
    Vec3 invert(const Vec3& q) const;
  };

  Mat3 linear_ = Mat3::Identity(), linear_inverse_ = Mat3::Identity();
  Vec3 shift_mm_ = Vec3::Zero();
  std::vector<Shear> shears_;
  std::vector<Bump> bumps_;
};

}  // namespace homolog::phantom
