#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/geometry.h"
#include "core/solve/elimination_plan.h"

namespace homolog {

/// Solves A X = B for A = Λ + diag(s): a graph's weighted Laplacian and a diagonal s > 0, whose values change while the
/// graph stays. A = L Lᵀ by the multifrontal method [Duff and Reid 1983; Liu 1992].
///
/// Factorising a front eliminates its own unknowns, the pivots, and leaves an update: what they take from the rest of
/// A, added into the front's parent in a tree. The updates are kept, so only fronts with a changed entry and those
/// above them have to be factorised again, which gives the same bits as factorising all.
///
/// Solving reads all of L twice. A large L does not stay in the processor's caches, so it is kept a second time in
/// single precision; all sums are in double precision. Since A⁻¹ has no negative entry and A⁻¹ s = 1, the error of a
/// solution is below about 1e-7 of half the range of B/s. Where that may be more than 1e-5 (mm), L is read in double
/// precision.
class SparseCholesky {
 public:
  explicit SparseCholesky(std::shared_ptr<const EliminationPlan> plan);

  /// Factorises what differs from the last call. `s`: n values > 0; `weights`: of the plan's edges, ≥ 0. False where a
  /// value is not, or where A is not positive definite to working precision: nothing is factorised then.
  [[nodiscard]] bool factorise(const VertexScalars& s, const VertexScalars& weights);

  /// X of A X = B; the last `factorise` must have succeeded.
  VertexScalars solve(const VertexScalars& b) const;
  Points solve(const Points& b) const;
  /// The same with L in double precision, whatever its size.
  Points solve_in_double(const Points& b) const;

  const EliminationPlan& plan() const { return *plan_; }
  int fronts_factorised() const { return fronts_factorised_; }  ///< by the last `factorise`

 private:
  struct alignas(32) FourRows {
    double rows[4];
  };
  struct alignas(16) FourShortRows {
    float rows[4];
  };

  struct Rooms;

  Eigen::Index beyond() const;
  bool take_entries(int front, const VertexScalars& diagonal, const VertexScalars& weights);
  void assemble(int front);
  void shorten(int front);
  bool factorise_stale(const VertexScalars& diagonal, const VertexScalars& weights);
  template <int Components, class Number, class Value>
  void forward(const Number* a, const double* corrections, int front, const Rooms& rooms, Value* x) const;
  template <int Components, class Number, class Value>
  void backward(const Number* a, const double* corrections, int front, const Rooms& rooms, Value* x) const;
  template <class Number, class Value>
  void substitute(const Number* factor, const double* corrections, Value* x) const;
  template <class Value>
  void solve_in_order(Value* x, bool in_short) const;
  std::optional<Vec3> middle_for_short(const Points& b) const;
  Points solve_xyz(const Points& b, const Vec3& known, bool in_short) const;

  std::shared_ptr<const EliminationPlan> plan_;
  VertexScalars s_;
  std::vector<double> entries_;  ///< of A, in the plan's order; NaN where none are factorised
  std::unique_ptr<FourRows[]> factor_, updates_;
  std::unique_ptr<FourShortRows[]> short_factor_;  ///< null where L is small
  std::vector<double> corrections_;                ///< of its diagonal
  int fronts_factorised_ = 0;
};

}  // namespace homolog
