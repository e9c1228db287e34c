#pragma once

#include <vector>

#include "core/mesh/files/volume_mesh.h"

namespace homolog {

/// How far tetrahedra are from their shape at rest. Each has this energy, with F the matrix that takes its rest to it
/// and J = det F:
///
///   (|F|² / (3 χ(J)^⅔))² + ½ λ (J² + 1) / χ(J),   χ(J) = (J + √(J² + ε²)) / 2.
///
/// The first part grows with what turns it into another shape, the second with what changes its volume. Both are finite
/// where an element is turned over, as long as ε > 0, and then the larger the smaller ε is: so a minimiser pulls it
/// back. Source: Garanzha et al. 2021, Foldover-free maps in 50 lines of code; the square is ours and holds the worst
/// ones back.
class VolumeEnergy {
 public:
  /// `rest`: n×3, scaled so that volumes are about those of the shapes that come.
  VolumeEnergy(const Tetrahedra& tetrahedra, const Points& rest);

  /// From now on the rest of an element is a regular tetrahedron of the same volume.
  void rest_regular(Eigen::Index t);

  /// The length that χ takes for little: 0.2 times how far the worst element is turned over, and next to nothing where
  /// none is.
  double epsilon_for(const Points& points) const;
  /// The least J.
  double least_determinant(const Points& points) const;
  /// The energy of all; with `gradient` also its derivative, n×3.
  double value(const Points& points, double epsilon, Points* gradient) const;

 private:
  Eigen::Matrix3d edges(Eigen::Index t, const Points& points) const;

  Tetrahedra tetrahedra_;
  std::vector<Eigen::Matrix3d> inverse_rest_;  ///< a tetrahedron's three edges from its first corner, inverted
  std::vector<Eigen::Index> start_;            ///< the start of each point's uses in `uses_`
  std::vector<Eigen::Index> uses_;             ///< 4 t + k: it is corner k of tetrahedron t
};

}  // namespace homolog
