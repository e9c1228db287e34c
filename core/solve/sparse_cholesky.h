#pragma once

#include <memory>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/solve/elimination_plan.h"

namespace homolog {

/// Solves A X = B for A = Λ + diag(s): a graph's weighted Laplacian and a diagonal s > 0, whose values change while the
/// graph stays. A = L Lᵀ by the multifrontal method [Duff and Reid 1983; Liu 1992].
///
/// Factorising a front eliminates its own unknowns, the pivots, and leaves an update: what they take from the rest of
/// A, added into the front's parent in a tree. The updates are kept, so only fronts with a changed entry and those
/// above them have to be factorised again, which gives the same bits as factorising all.
///
/// Solving reads all of L twice, up the tree and down again. So L is stored once, in double precision, as it is read
/// then [packed_front.h], and nothing but L.
class SparseCholesky {
 public:
  explicit SparseCholesky(std::shared_ptr<const EliminationPlan> plan);

  /// Factorises what differs from the last call. `s`: n values > 0; `weights`: of the plan's edges, ≥ 0. False where a
  /// value is not, or where A is not positive definite to working precision: nothing is factorised then.
  [[nodiscard]] bool factorise(const VertexScalars& s, const VertexScalars& weights);

  /// X of A X = B; the last `factorise` must have succeeded.
  VertexScalars solve(const VertexScalars& b) const;
  Points solve(const Points& b) const;

  const EliminationPlan& plan() const { return *plan_; }
  int fronts_factorised() const { return fronts_factorised_; }  ///< the fronts that the last `factorise` did

 private:
  struct alignas(32) FourRows {
    double rows[4];
  };
  bool takes_entries(int front, const VertexScalars& diagonal, const VertexScalars& weights);
  void assemble(int front);
  bool factorise_stale(const VertexScalars& diagonal, const VertexScalars& weights);
  void substitute(FourRows* x) const;

  std::shared_ptr<const EliminationPlan> plan_;
  std::vector<double> entries_;                  ///< A's entries, in the plan's order; NaN where none are factorised
  std::unique_ptr<FourRows[]> panel_, updates_;  ///< the front that is being factorised; of all
  std::unique_ptr<double[]> factor_;
  int fronts_factorised_ = 0;
};

}  // namespace homolog
