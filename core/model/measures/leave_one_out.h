#pragma once

#include "core/model/shape_model.h"

namespace homolog {

/// One shape y against the model that is built from all others: that model's axes, in the coordinates of the
/// whole set's components, and how much of y each of them holds.
///
/// Leaving shape i out takes ρ z zᵀ off the diagonal scatter D of the whole set, ρ = M/(M−1), z its coefficients. The
/// eigenvalues μ of the rest are roots of the secular equation 1 = ρ Σ_j z_j²/(d_j − μ) [Golub 1973], one between each
/// two neighbouring d; the axes are (D − μ)⁻¹ z, and y = ρ z lies on the axis of μ with the square 1 / ‖(D − μ)⁻¹ z‖².
/// So every mode count comes from one set of roots, and no model is built M times.
///
/// Where only the leading components are known, what y has beyond them counts as one more axis, with the variance that
/// the axes there have in the mean, weighted by themselves. Distances in the leading modes then err by about 1 %;
/// `squared_errors` and `error` need all components.
class LeaveOneOut {
 public:
  LeaveOneOut(const PrincipalComponents& components, Eigen::Index shape);

  /// ‖y − its reconstruction by the first m modes of the others‖², mm², for m = 0…`most_modes`.
  Eigen::VectorXd squared_errors(Eigen::Index most_modes) const;
  /// The error itself with `modes` modes in the coordinates of the whole set's components (r numbers): its
  /// points are basis(r) · error. Not clamped.
  Eigen::VectorXd error(Eigen::Index modes) const;
  /// The Mahalanobis distance of y from the others' mean in their first `modes` modes, or all of them where they are
  /// fewer.
  double mahalanobis(Eigen::Index modes) const;

 private:
  /// An axis of the others' model: its root μ = poles_[near] − offset, kept as an offset so that neither loses digits.
  struct Mode {
    double eigenvalue = 0;
    double square = 0;      ///< (axis · y)²; 0 for an axis that y does not touch
    Eigen::Index near = 0;  ///< which pole; −1 for an axis that y does not touch
    double offset = 0;
  };
  Mode root_between(Eigen::Index upper, bool down_to_zero) const;
  double distance(Eigen::Index pole, const Mode& mode) const { return poles_[pole] - poles_[mode.near] + mode.offset; }
  Eigen::VectorXd part_along(const Mode& mode) const;

  double shapes_ = 0;  ///< M
  bool knows_all_ = true;
  double rho_ = 1;
  Eigen::VectorXd z_;                ///< r coefficients of the shape
  std::vector<Eigen::Index> group_;  ///< the pole of each coefficient; −1 where the shape has none of it
  Eigen::VectorXd poles_;            ///< distinct d_j that the shape touches, descending
  Eigen::VectorXd weights_;          ///< Σ z_j² of each
  std::vector<Mode> modes_;          ///< axes of the others' model, by descending eigenvalue
  std::vector<Mode> beyond_;         ///< the part of y outside every model of the others: at most one
};

/// How far each of M shapes lies from the model that the others make with as many modes, in standard deviations (M
/// numbers): the modes are the others' own. Empty for fewer than four shapes.
Eigen::VectorXd left_out_distances(const PrincipalComponents& components, Eigen::Index modes);

/// The errors of all shapes with `modes` modes as combinations of the centred shapes, M×M, a shape a column: its error
/// in mm is centred · column. So errors can be had a few vertices at a time.
Eigen::MatrixXd left_out_errors(const PrincipalComponents& components, Eigen::Index modes);

}  // namespace homolog
