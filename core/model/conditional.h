#pragma once

#include <vector>

#include "core/model/shape_model.h"
#include "core/solve/shape_solver.h"

namespace homolog {

/// What a shape model expects of the whole shape where some of its landmarks are known.
struct Prediction {
  Eigen::VectorXd b;           ///< t expected coefficients, mm; not clamped
  Points points;               ///< n×3 expected shape, mm
  VertexScalars deviation_mm;  ///< standard deviation that is left of every landmark, over its three coordinates
};

/// The conditional Gaussian of a model x = mean + Φ b, b ~ N(0, λ), given the positions of `landmarks` (a row each,
/// where the model's shapes lie): b | y = (Φ_yᵀ Φ_y + σ² λ⁻¹)⁻¹ Φ_yᵀ (y − mean_y) [Albrecht 2013, §3.1]. σ² is that of
/// every coordinate of the positions, the model's own noise added. `noise_mm` > 0. No landmarks give the mean.
Prediction predict(const ShapeModel& model, const std::vector<Eigen::Index>& landmarks, const Points& positions,
                   double noise_mm);

/// The model with seven more modes after its own: shifts, small turns and size about the mean's centre (3 % of the
/// extent, 5°, 5 % of size), so that what is known of a shape that does not lie quite right is not taken for a change
/// of shape. Its modes are not orthogonal.
ShapeModel with_pose(const ShapeModel& model);

struct Completion {
  Points points;               ///< n×3, mm
  VertexScalars deviation_mm;  ///< of the model's prediction, in the case's size
};

/// A shape of the model's numbering, completed by what the model predicts for the rest of it: those landmarks whose
/// `known` is above 0 (1 fully) are given to `posed`, a model with_pose, brought to the shape by the similarity that
/// carries the mean to it; coefficients stay within ±3√λ. Eq. 3 then carries the prediction to where they are, with the
/// prediction as its reference. `strength` 0…1 goes from the shape to that; known landmarks stay where they are, and at
/// 0 all do. `solver` is of the shape's topology; `stiffness`: w.
/// Errors: a model of another vertex count, weights that cannot be factorised.
Result<Completion> completed(const ShapeModel& posed, const Points& shape, const VertexScalars& known, double noise_mm,
                             double strength, const VertexScalars& stiffness, ShapeSolver& solver);

}  // namespace homolog
