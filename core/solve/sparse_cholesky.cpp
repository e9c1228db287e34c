#include "core/solve/sparse_cholesky.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/solve/dense_front.h"
#include "core/solve/ordering.h"

namespace homolog {

namespace {

using Eigen::Index;

constexpr double unknown_value = std::numeric_limits<double>::quiet_NaN();  // which differs from every value

/// A column may join the front of its parent where the joint front keeps at most this share of zeros or is small. Both
/// were chosen by measurement, on spheres of 2,500 to 40,000 vertices.
constexpr double most_zeros = 0.3;
constexpr int small_pivots = 8;

SparsityGraph graph_of(const Eigen::SparseMatrix<double>& lower) {
  const auto each_edge = [&](const auto& visit) {
    for (int j = 0; j < lower.cols(); ++j) {
      for (int k = lower.outerIndexPtr()[j]; k < lower.outerIndexPtr()[j + 1]; ++k) {
        if (const int i = lower.innerIndexPtr()[k]; i != j) visit(i, j);
      }
    }
  };
  SparsityGraph graph{std::vector<int>(static_cast<std::size_t>(lower.cols()) + 1), {}};
  each_edge([&](int i, int j) { ++graph.start[i + 1], ++graph.start[j + 1]; });
  std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
  graph.neighbour.resize(graph.start.back());
  std::vector<int> next = graph.start;
  each_edge([&](int i, int j) { graph.neighbour[next[i]++] = j, graph.neighbour[next[j]++] = i; });
  return graph;
}

}  // namespace

/// For each column of L in the order of elimination: the row of its first entry below the diagonal, or −1, and how many
/// entries it has.
struct SparseCholesky::EliminationTree {
  std::vector<int> parent, count;

  /// Row i of L has entries on the paths up the tree from the entries of row i of A [Liu 1990]; walking them, row by
  /// row, finds the tree and counts the columns.
  EliminationTree(const SparsityGraph& graph, const std::vector<int>& order, const std::vector<int>& position)
      : parent(order.size(), -1), count(order.size(), 1) {
    std::vector<int> seen_in_row(order.size(), -1);
    for (int i = 0; i < static_cast<int>(order.size()); ++i) {
      for (int k = graph.start[order[i]]; k < graph.start[order[i] + 1]; ++k) {
        for (int j = position[graph.neighbour[k]]; j < i && seen_in_row[j] != i; j = parent[j]) {
          if (parent[j] < 0) parent[j] = i;
          ++count[j];
          seen_in_row[j] = i;
        }
      }
    }
  }

  /// For each column the last one of its front. A front joins its parent's where both together hold few zeros: one
  /// dense matrix is faster than two smaller ones [Ashcraft and Grimes 1989].
  std::vector<int> amalgamated() const {
    const auto entries = [](double pivots, double height) { return pivots * height - pivots * (pivots - 1) / 2; };
    std::vector<int> last(parent.size()), pivots(parent.size(), 1), height = count;
    std::vector<double> nonzeros(count.begin(), count.end());
    std::iota(last.begin(), last.end(), 0);
    for (std::size_t j = 0; j < parent.size(); ++j) {
      const int p = parent[j];
      if (p < 0) continue;
      const int joint = pivots[j] + pivots[p];
      const double kept = (nonzeros[j] + nonzeros[p]) / entries(joint, pivots[j] + height[p]);
      if (joint > small_pivots && kept < 1 - most_zeros) continue;
      last[j] = p;
      pivots[p] = joint;
      height[p] += pivots[j];
      nonzeros[p] += nonzeros[j];
    }
    for (std::size_t j = parent.size(); j-- > 0;) last[j] = last[last[j]];
    return last;
  }
};

SparseCholesky::SparseCholesky(const Eigen::SparseMatrix<double>& lower)
    : values_(Eigen::VectorXd::Constant(lower.nonZeros(), unknown_value)) {
  const SparsityGraph graph = graph_of(lower);
  auto [order, position] = nested_dissection(graph);
  position_ = std::move(position);
  make_fronts(EliminationTree(graph, order, position_), order);
  distribute_entries(lower);
  lay_out();
}

/// Numbers the unknowns anew, so that those of a front follow one another. Fronts come in the order of their last
/// columns, and so after their children.
void SparseCholesky::make_fronts(const EliminationTree& tree, const std::vector<int>& order) {
  const std::vector<int> last = tree.amalgamated();
  std::vector<int> front_of(order.size());
  int count = 0;
  for (std::size_t j = 0; j < order.size(); ++j) front_of[j] = last[j] == static_cast<int>(j) ? count++ : -1;
  fronts_.resize(count);
  for (std::size_t j = 0; j < order.size(); ++j) {
    front_of[j] = front_of[last[j]];
    ++fronts_[front_of[j]].pivots;
  }
  for (int f = 1; f < count; ++f) fronts_[f].first = fronts_[f - 1].first + fronts_[f - 1].pivots;
  std::vector<int> taken(count);
  for (std::size_t j = 0; j < order.size(); ++j) {
    const int f = front_of[j];
    position_[order[j]] = fronts_[f].first + taken[f]++;
    if (last[j] == static_cast<int>(j) && tree.parent[j] >= 0) {
      fronts_[f].parent = front_of[tree.parent[j]];
      fronts_[fronts_[f].parent].children.push_back(f);
    }
  }
}

/// Gives every entry of A to the front of its column, with column and row in the order of elimination.
void SparseCholesky::distribute_entries(const Eigen::SparseMatrix<double>& lower) {
  std::vector<int> front_of;
  for (int f = 0; f < fronts(); ++f) front_of.insert(front_of.end(), fronts_[f].pivots, f);
  for (int j = 0; j < lower.cols(); ++j) {
    for (int k = lower.outerIndexPtr()[j]; k < lower.outerIndexPtr()[j + 1]; ++k) {
      const auto [column, row] = std::minmax(position_[j], position_[lower.innerIndexPtr()[k]]);
      fronts_[front_of[column]].entries.push_back({k, row, column});
    }
  }
}

/// A front's rows are those of its entries of A and of its children's updates; finds them, and with them where
/// everything is stored.
void SparseCholesky::lay_out() {
  Index panels = 0, updates = 0;
  std::vector<int> seen_in(position_.size(), -1), place(position_.size());
  for (int f = 0; f < fronts(); ++f) {
    Front& front = fronts_[f];
    const auto add = [&](int row) {
      if (row < front.first + front.pivots || seen_in[row] == f) return;
      seen_in[row] = f;
      front.rows.push_back(row);
    };
    for (const Entry& entry : front.entries) add(entry.row);
    for (const int child : front.children) {
      for (const int row : fronts_[child].rows) add(row);
    }
    std::sort(front.rows.begin(), front.rows.end());
    std::iota(place.begin() + front.first, place.begin() + front.first + front.pivots, 0);
    int next = 4 * front.pivot_fours();
    for (const int row : front.rows) place[row] = next++;
    for (const int child : front.children) {
      for (const int row : fronts_[child].rows) fronts_[child].in_parent.push_back(place[row]);
    }
    for (Entry& entry : front.entries) {
      entry.row = place[entry.row];
      entry.column -= front.first;
    }
    front.panel = panels;
    front.update = updates;
    panels += Index{front.fours()} * front.pivots;
    updates += Index{2} * front.row_fours() * (front.row_fours() + 1);
    most_fours_ = std::max(most_fours_, front.fours());
  }
  factor_ = std::make_unique_for_overwrite<FourRows[]>(panels);
  updates_ = std::make_unique_for_overwrite<FourRows[]>(updates);
}

/// Writes the front's entries of A and its children's updates where it is going to be factorised.
void SparseCholesky::assemble(const Front& front, const double* values) {
  const Index fours = front.fours(), row_fours = front.row_fours(), below = 4 * front.pivot_fours();
  double* const panel = reinterpret_cast<double*>(factor_.get() + front.panel);
  double* const update = reinterpret_cast<double*>(updates_.get() + front.update);
  std::fill_n(panel, 4 * fours * front.pivots, 0.0);
  std::fill_n(update, 8 * row_fours * (row_fours + 1), 0.0);
  for (const Entry& entry : front.entries) panel[4 * fours * entry.column + entry.row] = values[entry.value];
  for (const int c : front.children) {
    const Front& child = fronts_[c];
    const auto* const taken = reinterpret_cast<const double*>(updates_.get() + child.update);
    const std::vector<int>& to = child.in_parent;
    for (std::size_t column = 0; column < to.size(); ++column) {
      const double* const from = taken + 4 * triangle_column(static_cast<Index>(column), child.row_fours());
      double* const into = to[column] < front.pivots
                               ? panel + 4 * fours * to[column]
                               : update + 4 * triangle_column(to[column] - below, row_fours) - below;
      for (std::size_t row = column; row < to.size(); ++row) into[to[row]] += from[row];
    }
  }
}

bool SparseCholesky::factorise_stale(const double* values) {
  fronts_factorised_ = 0;
  std::vector<char> stale(fronts_.size());
  for (int f = 0; f < fronts(); ++f) {
    const Front& front = fronts_[f];
    const auto changed = [&](const Entry& entry) { return values[entry.value] != values_[entry.value]; };
    if (!stale[f] && std::none_of(front.entries.begin(), front.entries.end(), changed)) continue;
    assemble(front, values);
    auto* const panel = reinterpret_cast<Lanes*>(factor_.get() + front.panel);
    auto* const update = reinterpret_cast<Lanes*>(updates_.get() + front.update);
    if (!factorise_panel(panel, front.pivots, front.fours(), update)) return false;
    ++fronts_factorised_;
    if (front.parent >= 0) stale[front.parent] = true;
  }
  return true;
}

bool SparseCholesky::factorise(const Eigen::SparseMatrix<double>& lower) {
  const bool done = run_widest([&] { return factorise_stale(lower.valuePtr()); });
  if (done) {
    values_ = lower.coeffs();
  } else {
    values_.setConstant(unknown_value);
  }
  return done;
}

/// L y = x, then Lᵀ z = y, in place and in the order of elimination.
template <class Value>
void SparseCholesky::substitute(Value* x) const {
  const auto room = std::make_unique<FourRows[]>(most_fours_ * (sizeof(Value) / sizeof(double)));
  Value* const local = reinterpret_cast<Value*>(room.get());
  const auto gather = [&](const Front& front) {
    Value* to = std::copy_n(x + front.first, front.pivots, local);
    to = std::fill_n(to, 4 * front.pivot_fours() - front.pivots, Value{});
    for (const int row : front.rows) *to++ = x[row];
    std::fill(to, local + 4 * front.fours(), Value{});
    return reinterpret_cast<const Lanes*>(factor_.get() + front.panel);
  };
  for (const Front& front : fronts_) {
    substitute_forward(gather(front), front.pivots, front.fours(), local);
    std::copy_n(local, front.pivots, x + front.first);
    const Value* from = local + 4 * front.pivot_fours();
    for (const int row : front.rows) x[row] = *from++;
  }
  for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {
    substitute_backward(gather(*front), front->pivots, front->fours(), local);
    std::copy_n(local, front->pivots, x + front->first);
  }
}

VertexScalars SparseCholesky::solve(const VertexScalars& b) const {
  VertexScalars ordered(b.size()), x(b.size());
  for (Index i = 0; i < b.size(); ++i) ordered[position_[i]] = b[i];
  run_widest([&] { substitute(ordered.data()); });
  for (Index i = 0; i < b.size(); ++i) x[i] = ordered[position_[i]];
  return x;
}

Points SparseCholesky::solve(const Points& b) const {
  std::vector<FourRows> ordered(b.rows());
  for (Index i = 0; i < b.rows(); ++i) ordered[position_[i]] = {b(i, 0), b(i, 1), b(i, 2), 0};
  run_widest([&] { substitute(reinterpret_cast<Lanes*>(ordered.data())); });
  Points x(b.rows(), 3);
  for (Index i = 0; i < b.rows(); ++i) x.row(i) = Eigen::Map<const Eigen::RowVector3d>(ordered[position_[i]].rows);
  return x;
}

}  // namespace homolog
