#pragma once

#include <vector>

#include "core/model/shape_model.h"
#include "core/solve/shape_solver.h"

namespace homolog {

/// The whole shape that a shape model expects where some of its vertices are known.
struct Prediction {
  Eigen::VectorXd b;           ///< t expected coefficients, mm; not clamped
  Points points;               ///< n×3 expected shape, mm
  VertexScalars deviation_mm;  ///< standard deviation that is left of every vertex, over its three coordinates
};

/// The conditional Gaussian of a model x = mean + Φ b, b ~ N(0, λ), given the positions of `landmarks` (a row each,
/// where the model's shapes lie): b | y = (Φ_yᵀ Φ_y + σ² λ⁻¹)⁻¹ Φ_yᵀ (y − mean_y) [Albrecht 2013, §3.1]. σ² is that of
/// every coordinate of the positions, the model's own noise added. No vertices give the mean.
/// Throws std::invalid_argument where `positions` has other rows than there are landmarks, for a landmark that is no
/// vertex of the model, and unless `noise_mm` > 0.
Prediction predict(const ShapeModel& model, const std::vector<Eigen::Index>& landmarks, const Points& positions,
                   double noise_mm);

/// The model with seven more modes after its own: shift, small turns and size about the mean's centre (3 % of the
/// extent, 5°, 5 % of size). So a shape that lies slightly off is not mistaken for another shape. The modes are not
/// orthogonal.
ShapeModel with_pose(const ShapeModel& model);

struct Completion {
  Points points;               ///< n×3, mm
  VertexScalars deviation_mm;  ///< deviation of the model's prediction, in the case's size
};

/// Completes a shape by what the model predicts for its unknown part. A similarity brings the model's mean to the
/// shape. The vertices whose `known` is above 0 (1: fully known) are given to `posed`, a model with_pose; coefficients
/// stay within ±3√λ. Eq. 3 then carries the prediction to the known vertices, with the prediction as its reference.
/// `strength` 0…1 goes from the shape to that result; known vertices never move, and at 0 none does. `solver` is of the
/// shape's topology; `stiffness`: w. Errors: a model of another vertex count, weights that cannot be factorised.
Result<Completion> completed(const ShapeModel& posed, const Points& shape, const VertexScalars& known, double noise_mm,
                             double strength, const VertexScalars& stiffness, ShapeSolver& solver);

}  // namespace homolog
