#pragma once

#include "core/base/result.h"

#include "core/adapt/image/profiles.h"

namespace homolog {

/// The look of the boundary in finished cases: the mean intensities along the normal of every vertex.
/// Vertices correspond, so each has a profile of its own.
class Appearance {
 public:
  /// Adds a mesh that lies on the boundary in its image. Where the image shows nothing, nothing is learned. Errors:
  /// another number of vertices than the cases before.
  Result<void> learn(const Volume& image, int frame, const Mesh& mesh);

  bool empty() const { return cases_ == 0; }
  Eigen::Index vertices() const { return mean_.cols(); }
  /// How far to both sides of a place it is compared, mm.
  static double reach_mm();

  /// Normalised correlation of the profile learned for each vertex with `profiles` around each sample, −1…1; NaN where
  /// the scan ends or nothing was learned. A contrast much weaker than that learned counts as less.
  Eigen::MatrixXf likeness(const Profiles& profiles) const;

 private:
  Eigen::MatrixXf mean_;   ///< samples × n, as Profiles
  Eigen::MatrixXf count_;  ///< how many cases each mean is of
  double step_mm_ = 0;     ///< the first case's step; later ones are sampled alike
  int cases_ = 0;
};

}  // namespace homolog
