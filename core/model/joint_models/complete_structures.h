#pragma once

#include <vector>

#include "core/model/joint_models/structure_parts.h"

namespace homolog {

/// A shape of several structures of which some are missing: 3n numbers, of which those of missing ones count for
/// nothing.
struct IncompleteShape {
  Eigen::VectorXd points;
  std::vector<bool> has;  ///< whether it has each structure
};

struct CompletedShape {
  Eigen::VectorXd points;                 ///< the shape; the points that it has are as they were
  double noise_mm = 0;                    ///< σ of every known coordinate that was taken
  std::vector<double> expected_error_mm;  ///< each structure's expected error; 0 of those that it has
  std::vector<double> mean_error_mm;      ///< the same where the others' mean, laid onto what is known, is taken
};

/// Completes a shape by what the joint model of the complete ones (columns, as they lie in their scans) expects given
/// the structures that are there: the conditional Gaussian of `predict`, in the pose in which the model's mean lies on
/// them, which may be off as with_pose allows. Neighbouring vertices err alike, and few shapes tell little: so σ is
/// that of eight, 1 to 128 mm, with which complete shapes are completed best, each by the model of the others and with
/// the same structures taken away. The error that is left then is the error to expect. The largest σ give about the
/// mean. Needs one structure that the shape has. Throws std::invalid_argument for fewer than three complete shapes, and
/// where the shape names other structures than the model has.
CompletedShape completed_shape(const ShapeMatrix& complete, const std::vector<StructurePart>& parts,
                               const IncompleteShape& shape, Alignment alignment);

}  // namespace homolog
