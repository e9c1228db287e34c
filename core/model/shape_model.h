#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/topology.h"
#include "core/model/alignment/procrustes.h"
#include "core/model/joint_models/structure_parts.h"
#include "core/template/template.h"

namespace homolog {

// What is given here is checked. A function throws std::invalid_argument for shapes of another size than the model's or
// with coordinates that are not finite, for a mode that there is not, and for a share beyond 0…1.

/// The principal components of M shapes: all of them, or the leading ones alone.
struct PrincipalComponents {
  Eigen::VectorXd mean;       ///< 3n
  ShapeMatrix centred;        ///< 3n×M, shapes − mean
  Eigen::VectorXd scatter;    ///< r eigenvalues of centredᵀ · centred, descending, > 0; r ≤ M − 1 is the rank
  Eigen::MatrixXd vectors;    ///< M×r, their unit eigenvectors
  double beyond = 0;          ///< the sum of the eigenvalues that were not computed; 0 where all were
  double beyond_squares = 0;  ///< the sum of their squares

  Eigen::Index shapes() const { return centred.cols(); }
  Eigen::Index vertices() const { return centred.rows() / 3; }
  /// λ of the covariance with 1/(M−1), mm²: all M − 1 of them, 0 beyond the rank; r where the leading ones are known.
  Eigen::VectorXd variances() const;
  /// The sum of all M − 1 of them, mm².
  double total_variance() const;
  /// r×M, the coefficients b of every shape, mm.
  Eigen::MatrixXd scores() const { return scatter.cwiseSqrt().asDiagonal() * vectors.transpose(); }
  /// M×r: centred · weights is the basis.
  Eigen::MatrixXd weights() const { return vectors * scatter.cwiseSqrt().cwiseInverse().asDiagonal(); }
  /// The first `count` axes as columns, 3n×count; all where there are fewer.
  Eigen::MatrixXd basis(Eigen::Index count) const;
};

/// Takes the shapes over. Beside them only the smaller of M×M and 3n×3n numbers is needed. Without shapes there are no
/// axes.
PrincipalComponents principal_components(ShapeMatrix shapes);
/// The leading `count` components, by Lanczos' method with restarts. If `count` is no small part of all, or the
/// shapes are few, it gives all: they are known as soon.
PrincipalComponents leading_components(ShapeMatrix shapes, Eigen::Index count);

/// Smallest number of modes whose variances hold `share` (0…1] of their sum, at least 1; 0 where all are 0.
Eigen::Index modes_holding(const Eigen::VectorXd& variances, double share);

/// A statistical shape model x = mean + basis · b [Erdt 2009, §2.3].
struct ShapeModel {
  std::shared_ptr<const Topology> topology;  ///< null for a model of points alone
  Eigen::VectorXd mean;                      ///< 3n, mm
  Eigen::MatrixXd basis;                     ///< 3n×t, orthonormal columns
  Eigen::VectorXd variances;                 ///< λ of the t modes, mm², descending
  double noise_variance = 0;                 ///< mm², of every coordinate, beside the modes
  Eigen::MatrixXd scores;                    ///< t×M coefficients of the training shapes, mm; may be empty
  std::vector<std::string> names;            ///< names of the training shapes; may be empty
  std::vector<StructurePart> parts;          ///< the structures of a joint model; else empty
  std::optional<StructurePoses> poses;       ///< how a joint model's structures lie
  std::optional<Alignment> alignment{};      ///< how the training shapes were aligned; none: the file does not say
  /// M: how far each training shape lies from the model of the others [leave_one_out.h]; empty: not known.
  Eigen::VectorXd left_out_distances{};
  std::vector<CompletedStructure> completed{};  ///< training shapes of a joint model of which parts were predicted
  std::optional<FacedNames> faced{};            ///< which part of a label the shapes are of; none: not known
  Eigen::Index modes() const { return variances.size(); }
};

/// The model of the first `modes` modes; of all where there are fewer.
ShapeModel model_of_modes(const PrincipalComponents& components, Eigen::Index modes,
                          std::shared_ptr<const Topology> topology, std::vector<std::string> names);
/// The model whose modes hold `share` of the variance.
ShapeModel make_model(const PrincipalComponents& components, double share, std::shared_ptr<const Topology> topology,
                      std::vector<std::string> names);

/// The vertices of one structure of a joint model, in all of its modes. The rows of the basis are those of the joint
/// model, so its columns are not orthonormal: for pictures and tables of the same modes.
ShapeModel part_of(const ShapeModel& model, const StructurePart& part);

/// Every b_i moved into ±limit·√λ_i [Erdt 2009, §2.3].
Eigen::VectorXd clamped(const ShapeModel& model, const Eigen::VectorXd& b, double limit = 3);
/// mean + basis · b for the first b.size() ≤ t modes.
Points shape_of(const ShapeModel& model, const Eigen::VectorXd& b);
/// The mean with mode `mode` (from 0) at `deviations` √λ.
Points mode_shape(const ShapeModel& model, Eigen::Index mode, double deviations);
/// b of a shape that lies where the model's shapes lie (see aligned_to); not clamped.
Eigen::VectorXd coefficients(const ShapeModel& model, const Points& shape);

/// count columns of b ~ N(0, λ), independent. The same seed gives the same numbers on every machine, and fewer
/// variances give the upper rows of what more would give.
Eigen::MatrixXd sampled_coefficients(const Eigen::VectorXd& variances, Eigen::Index count, std::uint64_t seed);
/// A random shape of the model, its coefficients clamped.
Points sampled_shape(const ShapeModel& model, std::uint64_t seed);

}  // namespace homolog
