#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// Fewer landmarks tell a similarity only.
inline constexpr Eigen::Index fewest_warp_landmarks = 4;
/// How well a person clicks a landmark, each coordinate.
inline constexpr double landmark_noise_mm = 0.7;

/// How an organ differs from its template under a similarity, as a Gaussian process: the covariance of each coordinate
/// of the displacement at two places is a Gaussian bump plus a linear part kept small. What the linear part's prior
/// allows (a few per cent of stretch) is little enough that four near-coplanar landmarks with some mm of error do not
/// stretch the mesh [docs/method.md §5].
class WarpKernel {
 public:
  /// `length_mm`: how far what is known at a place reaches.
  WarpKernel(const Eigen::RowVector3d& centre, double length_mm) : centre_(centre), length_mm_(length_mm) {}
  Eigen::MatrixXd operator()(const Points& a, const Points& b) const;  ///< in mm²; a row for each of `a`

 private:
  Eigen::RowVector3d centre_;
  double length_mm_;
};

/// A smooth displacement of space, regressed over landmarks, with a noise term.
class LandmarkWarp {
 public:
  /// `from`, `to`: k×3, where landmarks are (under the similarity) and where they belong, mm.
  /// `length_mm`: how far a landmark's pull reaches (0.25 of the template's bounding-box diagonal serves organs).
  LandmarkWarp(const Points& from, const Points& to, double length_mm);

  Points apply(const Points& points) const;

 private:
  Points from_;
  WarpKernel kernel_;
  Eigen::MatrixX3d weights_;
};

/// A placed reference carried to landmarks.
struct WarpedReference {
  Points points;
  double share = 0;    ///< 0 … 1: of the warp that was used; 0 below four landmarks, which tell a similarity only
  bool folds = false;  ///< the whole warp would turn triangles over: landmarks placed in the wrong order
};

/// A displacement of a placed reference, taken as far as it turns no triangle over. `offset`: n×3, mm.
WarpedReference without_folds(const Topology& topology, const Points& placed, const Points& offset);

/// The landmark warp of a reference, as far as it turns no triangle over. `placed`: n×3, the template under its
/// similarity; `from`, `to`: as for LandmarkWarp, mm.
WarpedReference warp_to_landmarks(const Topology& topology, const Points& placed, const Points& from, const Points& to);

}  // namespace homolog
