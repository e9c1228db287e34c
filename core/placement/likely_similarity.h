#pragma once

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The prior of a placement, before any landmark speaks.
struct PlacementPrior {
  Similarity around;            ///< the likeliest placement
  double turn_rad = 0.35;       ///< standard deviation of a turn about each axis
  double size_deviation = 0.5;  ///< standard deviation of the logarithm of the scale

  /// κ of the matrix Fisher distribution exp(κ tr(R₀ᵀR)), which has about that spread [Mardia & Jupp 2000, §13.2].
  double concentration() const { return 1 / (2 * turn_rad * turn_rad); }
};

/// How far a true landmark lies from where the right similarity puts the template's, each coordinate: organs differ by
/// more than a similarity, and a person clicks some mm off. A share of the organ's diagonal.
inline constexpr double landmark_deviation_share = 0.045;

/// Fewer landmarks leave a rotation open altogether; the automatic fit does not place by them.
inline constexpr Eigen::Index fewest_placing_landmarks = 3;

/// The most likely similarity that carries landmarks `from` (in the template's frame) to `to`, both k×3, row by row.
/// Landmarks decide the part of the rotation that they determine well. The rest stays as in the prior: the spin about a
/// line that they lie near, or all rotation if they lie together. Without noise and prior it is Umeyama's.
/// `diagonal_mm`: of the template's bounding box, in its own frame. Throws std::invalid_argument where `from` and `to`
/// are not as many.
Similarity likely_similarity(const Points& from, const Points& to, const PlacementPrior& prior, double diagonal_mm);

}  // namespace homolog
