#pragma once

#include <Eigen/Cholesky>

#include "core/mesh/topology.h"

namespace homolog {

/// How far places may be displaced: what two places have in common falls with their distance.
struct DisplacementScales {
  double bend_mm, bend_reach_mm;  ///< smooth part, root mean square a coordinate; over which distance it holds
  double fine_mm, fine_reach_mm;  ///< the same for its finer part
  double stretch;                 ///< slope that is the same everywhere: stretch, shear or turn
};

/// Displacements of space that are smooth: a Gaussian process, represented by bumps around some nodes and by a slope.
class SmoothDisplacement {
 public:
  /// nodes×3. Independent and of standard normal distribution before anything is known.
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  /// The values of a displacement at k places.
  struct Basis {
    Points places;              ///< k×3, mm
    Eigen::MatrixXd value;      ///< k×nodes: times the coefficients, the displacement
    Eigen::MatrixXd steepness;  ///< k×nodes: of the bumps, a mm from their nodes
  };

  /// `nodes` and `centre`, around which it stretches: mm.
  SmoothDisplacement(const Points& nodes, const Eigen::RowVector3d& centre, const DisplacementScales& scales);

  Eigen::Index nodes() const { return nodes_.rows(); }
  Basis basis(const Points& places) const;
  /// Says how far k places are displaced, k×3, mm.
  Points at(const Points& places, const Coefficients& by) const;
  /// `normals` (k×3, unit) at the places of `basis` when these are displaced.
  Points turned_normals(const Basis& basis, const Points& normals, const Coefficients& by) const;

 private:
  Eigen::MatrixXd covariance(const Points& places, Eigen::MatrixXd* steepness = nullptr) const;
  Coefficients bumps(const Coefficients& by) const { return root_.matrixU().solve(by); }

  Eigen::RowVector3d centre_;
  Points nodes_;  ///< places from the centre
  DisplacementScales scales_;
  Eigen::LLT<Eigen::MatrixXd> root_;  ///< the nodes' covariance, factorised
};

}  // namespace homolog
