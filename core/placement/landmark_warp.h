#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// Fewer landmarks tell a similarity only.
inline constexpr Eigen::Index fewest_warp_landmarks = 4;

/// The lengths that a warp takes for usual.
struct WarpLengths {
  double reach_mm;  ///< how far what is known at a place reaches
  double bump_mm;   ///< how far a landmark typically is off after the similarity
  double noise_mm;  ///< how well a person clicks a landmark, each coordinate
};
/// For an organ with a bounding box of this diagonal: shares of it, which for a kidney are 35, 6 and 0.7 mm.
WarpLengths warp_lengths(double diagonal_mm);
/// Cases that were begun when bump and noise were mm have 6 and 0.7 mm, whatever the size.
WarpLengths older_warp_lengths(double diagonal_mm);

/// How an organ differs from its template under a similarity, as a Gaussian process: the covariance of each coordinate
/// of the displacement at two places is a Gaussian bump plus a linear part kept small. The stretch that the linear
/// part's prior allows (a few per cent) is little enough that four near-coplanar landmarks with some mm of error do not
/// stretch the mesh [docs/method.md §4].
class WarpKernel {
 public:
  WarpKernel(const Eigen::RowVector3d& centre, const WarpLengths& lengths) : centre_(centre), lengths_(lengths) {}
  Eigen::MatrixXd operator()(const Points& a, const Points& b) const;  ///< in mm²; a row for each of `a`

 private:
  Eigen::RowVector3d centre_;
  WarpLengths lengths_;
};

/// A smooth displacement of space, regressed over landmarks, with a noise term.
class LandmarkWarp {
 public:
  /// `from`, `to`: k×3, where landmarks are (under the similarity) and where they belong, mm.
  LandmarkWarp(const Points& from, const Points& to, const WarpLengths& lengths);

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
  bool folds = false;  ///< it would turn triangles over, usually since landmarks were placed in the wrong order
};

/// A displacement of a placed reference, taken as far as it turns no triangle over. `offset`: n×3, mm.
WarpedReference without_folds(const Topology& topology, const Points& placed, const Points& offset);

/// The landmark warp of a reference, as far as it turns no triangle over. `placed`: n×3, the template under its
/// similarity; `from`, `to`: as for LandmarkWarp, mm.
WarpedReference warp_to_landmarks(const Topology& topology, const Points& placed, const Points& from, const Points& to,
                                  const WarpLengths& lengths);

}  // namespace homolog
