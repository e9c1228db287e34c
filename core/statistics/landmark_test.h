#pragma once

#include <Eigen/Core>

#include "core/base/processes/progress.h"
#include "core/statistics/design.h"
#include "core/statistics/permutations.h"

namespace homolog {

/// The test of one term at every vertex.
struct LandmarkTest {
  Eigen::VectorXd p;  ///< (b + 1) ÷ (m + 1); 1 where nothing varies
  Eigen::VectorXd q;  ///< false discovery rate over the vertices
  /// How far the term moves a vertex, mm, the other terms held. Two groups: between their means; more: the largest
  /// such distance. Numbers: for one standard deviation of them. Else the root mean square over the cases.
  Eigen::VectorXd effect;
  Eigen::MatrixXd offset;  ///< n×3: from the first group to the second, or for one deviation more; empty: of neither
};

/// Tests a term at every vertex as test_terms does of all together, with the same permutations. `responses`: a case a
/// column, x y z of vertex 0, of vertex 1, … (mm). Progress that was cancelled leaves the values without meaning.
LandmarkTest test_landmarks(const Design& design, std::size_t term, const Eigen::MatrixXd& responses,
                            const Eigen::VectorXd& root_weights, const Permutations& permutations,
                            Progress* progress = nullptr);

}  // namespace homolog
