#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/mesh/topology.h"

namespace homolog {

class SparseCholesky;

/// Solves (M + H) X = B, M = I + Λ [Erdt 2009, Eq. 3 as normal equations; docs/method.md §1], H a diagonal that holds
/// confirmed vertices. Three costs: the first solver of a topology makes its elimination plan, which the topology keeps
/// for all others; `factorise` (stiffness, confirmed regions); `solve` (every frame). A change of few weights
/// factorises what depends on them, with the same result as factorising all.
class ShapeSolver {
 public:
  /// Throws std::invalid_argument without a topology, and std::bad_alloc or std::runtime_error where no order of
  /// elimination is found [ordering.h].
  explicit ShapeSolver(std::shared_ptr<const Topology> topology);
  ~ShapeSolver();
  ShapeSolver(ShapeSolver&&) noexcept;
  ShapeSolver& operator=(ShapeSolver&&) noexcept;

  /// `w`: n stiffness weights. `hold`: n weights, each finite and above −1, added to the diagonal; or empty for none.
  /// Errors: not n of them; a weight that is not finite, or not positive; weights too far apart to be solved. After the
  /// last one nothing is factorised.
  Result<void> factorise(const VertexScalars& w, const VertexScalars& hold = {});

  /// n values in, n values out; one that is not finite gives others that are not. Throws std::invalid_argument where
  /// nothing is factorised, or where there are not n.
  VertexScalars solve(const VertexScalars& b) const;
  Points solve(const Points& b) const;

  const std::shared_ptr<const Topology>& topology() const { return topology_; }
  const VertexScalars& weights() const { return w_; }
  const VertexScalars& hold() const { return hold_; }
  /// How many entries of the factor may differ from zero.
  Eigen::Index factor_entries() const;

 private:
  void check_rows(Eigen::Index rows) const;

  std::shared_ptr<const Topology> topology_;
  VertexScalars w_, hold_;
  std::unique_ptr<SparseCholesky> factor_;
};

/// The pull of a held vertex, times all that pulls at it otherwise.
constexpr double holding_weight = 1e4;
/// Weights that hold vertices almost still (`held`: 0 free … 1). A held vertex follows only a ten-thousandth of the
/// pull, so it can be put back exactly afterwards. The solution fades towards it without a tear. `w`: the stiffness
/// weights.
VertexScalars firm_hold(const Topology& topology, const VertexScalars& w, const VertexScalars& held);

/// The length over which stiffness carries an edit on a regular mesh of edge `edge_mm`: ℓ = h·√(3w), in mm. This is
/// what is shown and what is kept when the vertex count changes.
double stiffness_length_mm(double w, double edge_mm);
double stiffness_from_length(double length_mm, double edge_mm);

}  // namespace homolog
