#pragma once

#include "core/base/geometry.h"

namespace homolog {

/// A smooth displacement of space, regressed over landmarks: a Gaussian process whose kernel is a Gaussian bump plus a
/// linear part kept small, with a noise term. What the linear part's prior allows (a few per cent of stretch) is little
/// enough that four near-coplanar landmarks with some mm of error do not stretch the mesh [docs/method.md §5].
class LandmarkWarp {
 public:
  /// `from`, `to`: k×3, where landmarks are (under the similarity) and where they belong, mm.
  /// `length_mm`: how far a landmark's pull reaches (0.25 of the template's bounding-box diagonal serves organs).
  LandmarkWarp(const Points& from, const Points& to, double length_mm);

  Points apply(const Points& points) const;

 private:
  Eigen::MatrixXd kernel(const Points& points) const;  ///< points × landmarks
  Points from_;
  Eigen::RowVector3d centre_;
  double length_mm_;
  Eigen::MatrixX3d weights_;
};

}  // namespace homolog
