#include "core/solve/sparse_cholesky.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/solve/dense_front.h"
#include "core/solve/packed_front.h"

namespace homolog {

namespace {

using Eigen::Index;
using Front = EliminationPlan::Front;

constexpr double unknown_value = std::numeric_limits<double>::quiet_NaN();  // which differs from every value

}  // namespace

SparseCholesky::SparseCholesky(std::shared_ptr<const EliminationPlan> plan)
    : plan_(std::move(plan)),
      entries_(plan_->entries().size(), unknown_value),
      panel_(std::make_unique<FourRows[]>(plan_->panel_fours() + block_pivots * plan_->most_fours())),
      updates_(std::make_unique_for_overwrite<FourRows[]>(plan_->update_fours())),
      factor_(std::make_unique_for_overwrite<double[]>(plan_->factor_numbers())) {}

/// Takes over the front's entries of A; whether any differs.
bool SparseCholesky::takes_entries(int f, const VertexScalars& diagonal, const VertexScalars& weights) {
  const Front& front = plan_->fronts()[f];
  const std::vector<int>& start = plan_->entry_start();
  bool changed = false;
  for (int column = front.first; column < front.first + front.pivots; ++column) {
    for (int k = start[column]; k < start[column + 1]; ++k) {
      const double entry = k == start[column] ? diagonal[column] : -weights[plan_->entries()[k].value];
      changed |= entry != entries_[k];
      entries_[k] = entry;
    }
  }
  return changed;
}

/// Writes the front's entries of A and its children's updates where it is going to be factorised.
void SparseCholesky::assemble(int f) {
  const Front& front = plan_->fronts()[f];
  const Index fours = front.fours(), row_fours = front.row_fours(), below = 4 * front.pivot_fours();
  double* const panel = reinterpret_cast<double*>(panel_.get());
  double* const update = reinterpret_cast<double*>(updates_.get() + front.update);
  std::fill_n(panel, 4 * fours * front.pivots, 0.0);
  std::fill_n(update, 8 * row_fours * (row_fours + 1), 0.0);
  const std::vector<int>& start = plan_->entry_start();
  for (int column = 0; column < front.pivots; ++column) {
    for (int k = start[front.first + column]; k < start[front.first + column + 1]; ++k)
      panel[4 * fours * column + plan_->entries()[k].place] = entries_[k];
  }
  for (const int c : plan_->children(f)) {
    const Front& child = plan_->fronts()[c];
    const auto* const taken = reinterpret_cast<const double*>(updates_.get() + child.update);
    const auto to = plan_->places_in_parent(c);
    const Index child_fours = child.row_fours();
    for (std::size_t column = 0; column < to.size(); ++column) {
      const double* const from = taken + 4 * triangle_column(static_cast<Index>(column), child_fours);
      double* const into = to[column] < below ? panel + 4 * fours * to[column]
                                              : update + 4 * triangle_column(to[column] - below, row_fours) - below;
      for (std::size_t row = column; row < to.size(); ++row) into[to[row]] += from[row];
    }
  }
}

bool SparseCholesky::factorise_stale(const VertexScalars& diagonal, const VertexScalars& weights) {
  fronts_factorised_ = 0;
  std::vector<char> stale(plan_->fronts().size());
  for (int f = 0; f < static_cast<int>(stale.size()); ++f) {
    const Front& front = plan_->fronts()[f];
    if (!takes_entries(f, diagonal, weights) && !stale[f]) continue;
    assemble(f);
    auto* const panel = reinterpret_cast<Lanes*>(panel_.get());
    auto* const update = reinterpret_cast<Lanes*>(updates_.get() + front.update);
    if (!run_widest([&] { return factorise_panel(panel, front.pivots, front.fours(), update); })) return false;
    run_widest([&] { pack_front(panel, front.pivots, front.rows, front.fours(), factor_.get() + front.factor); });
    ++fronts_factorised_;
    if (front.parent >= 0) stale[front.parent] = true;
  }
  return true;
}

bool SparseCholesky::factorise(const VertexScalars& s, const VertexScalars& weights) {
  assert(s.size() == plan_->unknowns() && weights.size() == plan_->edges());
  VertexScalars diagonal = VertexScalars::Zero(s.size());  // in the order of elimination
  const std::vector<int>& start = plan_->entry_start();
  for (int column = 0; column < plan_->unknowns(); ++column) {
    diagonal[column] += s[plan_->entries()[start[column]].value];
    for (int k = start[column] + 1; k < start[column + 1]; ++k) {
      const EliminationPlan::Entry& entry = plan_->entries()[k];
      diagonal[column] += weights[entry.value];
      diagonal[entry.row] += weights[entry.value];
    }
  }
  const bool usable = (s.array() > 0).all() && (weights.array() >= 0).all() && diagonal.allFinite();
  const bool done = usable && factorise_stale(diagonal, weights);
  if (!done) std::fill(entries_.begin(), entries_.end(), unknown_value);
  return done;
}

/// L y = x, then Lᵀ z = y, in place and in the order of elimination.
void SparseCholesky::substitute(FourRows* x) const {
  Lanes* const xyz = reinterpret_cast<Lanes*>(x);
  const auto with_block = [&](int f, int first, const auto& work) __attribute__((always_inline)) {
    const Front& front = plan_->fronts()[f];
    with_width<block_pivots>(
        front.pivots - first, [&](auto width) __attribute__((always_inline)) {
          const int next = first + width, rows = front.pivots + front.rows - next;
          work(width, plan_->places(f).data() + next, rows, xyz + front.first + first);
        });
  };
  run_widest([&] {
    const int fronts = static_cast<int>(plan_->fronts().size());
    const double* l = factor_.get();
    const auto up = [&](auto width, const int* place, int rows, Lanes* own) __attribute__((always_inline)) {
      forward<width>(l, place, rows, own, xyz);
      l += block_numbers(width, rows);
    };
    const auto down = [&](auto width, const int* place, int rows, Lanes* own) __attribute__((always_inline)) {
      l -= block_numbers(width, rows);
      backward<width>(l, place, rows, own, xyz);
    };
    for (int f = 0; f < fronts; ++f) {
      for (int first = 0; first < plan_->fronts()[f].pivots; first += block_pivots) with_block(f, first, up);
    }
    for (int f = fronts; f-- > 0;) {
      const int last = (plan_->fronts()[f].pivots - 1) / block_pivots * block_pivots;
      for (int first = last; first >= 0; first -= block_pivots) with_block(f, first, down);
    }
  });
}

/// As x alone: it takes the time of x, y and z together.
VertexScalars SparseCholesky::solve(const VertexScalars& b) const {
  const auto ordered = std::make_unique_for_overwrite<FourRows[]>(b.size());
  for (Index k = 0; k < b.size(); ++k) ordered[k] = {b[plan_->order()[k]], 0, 0, 0};
  substitute(ordered.get());
  return VertexScalars::NullaryExpr(b.size(), [&](Index i) { return ordered[plan_->position()[i]].rows[0]; });
}

Points SparseCholesky::solve(const Points& b) const {
  const auto ordered = std::make_unique_for_overwrite<FourRows[]>(b.rows());
  const int *const order = plan_->order().data(), *const position = plan_->position().data();
  for (Index k = 0; k < b.rows(); ++k) {
    const double* const from = b.data() + 3 * Index{order[k]};
    ordered[k] = {from[0], from[1], from[2], 0};
  }
  substitute(ordered.get());
  Points x(b.rows(), 3);
  for (Index i = 0; i < b.rows(); ++i) std::copy_n(ordered[position[i]].rows, 3, x.data() + 3 * i);
  return x;
}

}  // namespace homolog
