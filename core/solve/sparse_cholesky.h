#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "core/base/geometry.h"

namespace homolog {

/// A = L Lᵀ of a sparse symmetric positive definite A whose values change while its pattern stays: the multifrontal
/// method [Duff and Reid 1983; Liu 1992].
///
/// The unknowns are eliminated in the order of a nested dissection. Successive columns of L with (nearly) the same rows
/// make a front, a small dense matrix. Factorising a front eliminates its own unknowns, the pivots, and leaves an
/// update: what they take from the rest of A, added into the front's parent in a tree. The updates are kept, so only
/// fronts with a changed entry and those above them have to be factorised again, which gives the same bits as
/// factorising all. That costs 1.2 to 1.4 times the memory of L, 6 MB for a mesh of 10,000 vertices.
class SparseCholesky {
 public:
  /// Orders and analyses. `lower`: lower triangle of A, n×n, compressed, with every diagonal entry; its values are not
  /// read.
  explicit SparseCholesky(const Eigen::SparseMatrix<double>& lower);

  /// Factorises what differs from the last call; `lower` has the pattern given at construction. False where A is not
  /// positive definite to working precision: nothing is factorised then.
  [[nodiscard]] bool factorise(const Eigen::SparseMatrix<double>& lower);

  /// X of A X = B; the last `factorise` must have succeeded.
  VertexScalars solve(const VertexScalars& b) const;
  Points solve(const Points& b) const;

  int fronts() const { return static_cast<int>(fronts_.size()); }
  int fronts_factorised() const { return fronts_factorised_; }  ///< by the last `factorise`

 private:
  struct EliminationTree;
  /// Rows are stored in fours [dense_front.h]. A front's pivots and the rows below them begin a four each; what is left
  /// of their last one is zero.
  struct alignas(32) FourRows {
    double rows[4];
  };
  struct Entry {
    int value;        ///< its place among the values of A
    int row, column;  ///< in the front
  };
  struct Front {
    int first = 0, pivots = 0;  ///< the columns of L it holds
    int parent = -1;
    std::vector<int> children;
    std::vector<int> rows;       ///< of L below the pivots, ascending
    std::vector<int> in_parent;  ///< which rows of the parent's front they are
    std::vector<Entry> entries;  ///< of A in its columns
    Eigen::Index panel = 0;      ///< where its columns of L begin in factor_
    Eigen::Index update = 0;     ///< where its update begins in updates_

    int pivot_fours() const { return (pivots + 3) / 4; }
    int row_fours() const { return (static_cast<int>(rows.size()) + 3) / 4; }
    int fours() const { return pivot_fours() + row_fours(); }
  };

  void make_fronts(const EliminationTree& tree, const std::vector<int>& order);
  void distribute_entries(const Eigen::SparseMatrix<double>& lower);
  void lay_out();
  void assemble(const Front& front, const double* values);
  bool factorise_stale(const double* values);
  template <class Value>
  void substitute(Value* x) const;

  std::vector<int> position_;  ///< of each unknown in the order of elimination
  std::vector<Front> fronts_;  ///< children before their parents
  Eigen::VectorXd values_;     ///< those of A that are factorised; NaN where none are
  std::unique_ptr<FourRows[]> factor_, updates_;
  int most_fours_ = 0;  ///< of any front
  int fronts_factorised_ = 0;
};

}  // namespace homolog
