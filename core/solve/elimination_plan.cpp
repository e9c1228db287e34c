#include "core/solve/elimination_plan.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "core/mesh/topology.h"
#include "core/solve/ordering.h"

namespace homolog {

namespace {

std::atomic<int> plans_made = 0;

/// A column may join the front of its parent where the joint front keeps at most this share of zeros or is small. Both
/// were chosen by measurement, on spheres of 2,500 to 40,000 vertices.
constexpr double most_zeros = 0.3;
constexpr int small_pivots = 8;

SparsityGraph graph_of(int unknowns, const EliminationPlan::Edges& edges) {
  SparsityGraph graph{std::vector<int>(static_cast<std::size_t>(unknowns) + 1), std::vector<int>(2 * edges.size())};
  for (const auto& [i, j] : edges) ++graph.start[i + 1], ++graph.start[j + 1];
  std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
  std::vector<int> next = graph.start;
  for (const auto& [i, j] : edges) graph.neighbour[next[i]++] = j, graph.neighbour[next[j]++] = i;
  return graph;
}

/// The places where each of `counts` consecutive parts begins, and where the last one ends.
std::vector<int> starts_of(const std::vector<int>& counts) {
  std::vector<int> start(counts.size() + 1);
  std::partial_sum(counts.begin(), counts.end(), start.begin() + 1);
  return start;
}

}  // namespace

/// For each column of L in the order of elimination: the row of its first entry below the diagonal, or −1, and how many
/// entries it has.
struct EliminationPlan::Tree {
  std::vector<int> parent, count;

  /// Row i of L has entries on the paths up the tree from the entries of row i of A [Liu 1990]; walking them, row by
  /// row, finds the tree and counts the columns.
  Tree(const SparsityGraph& graph, const Ordering& ordering)
      : parent(ordering.order.size(), -1), count(ordering.order.size(), 1) {
    std::vector<int> seen_in_row(parent.size(), -1);
    for (int i = 0; i < static_cast<int>(parent.size()); ++i) {
      const int unknown = ordering.order[i];
      for (int k = graph.start[unknown]; k < graph.start[unknown + 1]; ++k) {
        for (int j = ordering.position[graph.neighbour[k]]; j < i && seen_in_row[j] != i; j = parent[j]) {
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

EliminationPlan::EliminationPlan(int unknowns, const Edges& edges) {
  const SparsityGraph graph = graph_of(unknowns, edges);
  Ordering ordering = nested_dissection(graph);
  const Tree tree(graph, ordering);
  nonzeros_ = std::accumulate(tree.count.begin(), tree.count.end(), Eigen::Index{0});
  position_ = std::move(ordering.position);
  make_fronts(tree, ordering.order);
  place_entries(edges);
  lay_out();
  ++plans_made;
}

int EliminationPlan::made() {
  return plans_made;
}

/// Numbers the unknowns anew, so that those of a front follow one another. Fronts come in the order of their last
/// columns, and so after their children.
void EliminationPlan::make_fronts(const Tree& tree, const std::vector<int>& order) {
  const std::vector<int> last = tree.amalgamated();
  std::vector<int> front_of(order.size());
  int count = 0;
  for (std::size_t j = 0; j < order.size(); ++j) front_of[j] = last[j] == static_cast<int>(j) ? count++ : -1;
  fronts_.resize(count);
  for (std::size_t j = 0; j < order.size(); ++j) {
    front_of[j] = front_of[last[j]];
    ++fronts_[front_of[j]].pivots;
  }
  int first = 0;
  for (Front& front : fronts_) {
    front.first = first;
    first += front.pivots;
  }
  order_.resize(order.size());
  std::vector<int> taken(count), children(count);
  for (std::size_t j = 0; j < order.size(); ++j) {
    const int f = front_of[j];
    const int place = fronts_[f].first + taken[f]++;
    position_[order[j]] = place;
    order_[place] = order[j];
    if (last[j] == static_cast<int>(j) && tree.parent[j] >= 0) {
      fronts_[f].parent = front_of[tree.parent[j]];
      ++children[fronts_[f].parent];
    }
  }
  child_start_ = starts_of(children);
  children_.resize(child_start_.back());
  std::vector<int> next = child_start_;
  for (int f = 0; f < count; ++f)
    if (fronts_[f].parent >= 0) children_[next[fronts_[f].parent]++] = f;
}

/// Every entry of A's lower triangle goes to its column in the order of elimination; rows ascend from the diagonal.
void EliminationPlan::place_entries(const Edges& edges) {
  std::vector<int> counts(position_.size(), 1);
  for (const auto& [i, j] : edges) ++counts[std::min(position_[i], position_[j])];
  entry_start_ = starts_of(counts);
  entries_.resize(entry_start_.back());
  std::vector<int> next = entry_start_;
  const auto add = [&](int column, int row, int value) { entries_[next[column]++] = {row, 0, value}; };
  for (int i = 0; i < unknowns(); ++i) add(position_[i], position_[i], i);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [column, row] = std::minmax(position_[edges[e][0]], position_[edges[e][1]]);
    add(column, row, static_cast<int>(e));
  }
  for (int j = 0; j < unknowns(); ++j)
    std::sort(entries_.begin() + entry_start_[j], entries_.begin() + entry_start_[j + 1],
              [](const Entry& a, const Entry& b) { return a.row < b.row; });
}

/// A front's rows are those of its entries of A and of its children's updates; finds them, and with them where
/// everything is stored.
void EliminationPlan::lay_out() {
  std::vector<int> seen_in(position_.size(), -1), place(position_.size());
  place_start_.assign(1, 0);
  for (int f = 0; f < static_cast<int>(fronts_.size()); ++f) {
    Front& front = fronts_[f];
    const auto add = [&](int row) {
      if (row < front.first + front.pivots || seen_in[row] == f) return;
      seen_in[row] = f;
      places_.push_back(row);
    };
    const auto each_row_of = [&](int child, const auto& work) {
      for (int k = place_start_[child] + fronts_[child].pivots; k < place_start_[child + 1]; ++k) work(k);
    };
    for (int k = 0; k < front.pivots; ++k) places_.push_back(front.first + k);
    const int below = static_cast<int>(places_.size());
    const int first_entry = entry_start_[front.first], last_entry = entry_start_[front.first + front.pivots];
    for (int k = first_entry; k < last_entry; ++k) add(entries_[k].row);
    for (const int child : children(f)) each_row_of(child, [&](int k) { add(places_[k]); });
    std::sort(places_.begin() + below, places_.end());
    place_start_.push_back(static_cast<int>(places_.size()));
    front.rows = place_start_.back() - below;
    places_in_parent_.resize(places_.size());
    std::iota(place.begin() + front.first, place.begin() + front.first + front.pivots, 0);
    int next = 4 * front.pivot_fours();
    for (int k = below; k < place_start_.back(); ++k) place[places_[k]] = next++;
    for (const int child : children(f)) each_row_of(child, [&](int k) { places_in_parent_[k] = place[places_[k]]; });
    for (int k = first_entry; k < last_entry; ++k) entries_[k].place = place[entries_[k].row];
    front.factor = factor_numbers_;
    front.update = update_fours_;
    const Eigen::Index pivots = front.pivots, row_fours = front.row_fours();
    factor_numbers_ += pivots * (pivots + 1) / 2 + pivots * front.rows;
    update_fours_ += 2 * row_fours * (row_fours + 1);
    panel_fours_ = std::max(panel_fours_, front.fours() * pivots);
    most_fours_ = std::max(most_fours_, front.fours());
  }
}

std::shared_ptr<const EliminationPlan> elimination_plan(const Topology& topology) {
  Topology::PlanKept& kept = topology.plan_kept();
  const std::lock_guard lock(kept.mutex);
  if (!kept.plan) {
    kept.plan = std::make_shared<const EliminationPlan>(static_cast<int>(topology.vertices()), topology.edges());
  }
  return kept.plan;
}

}  // namespace homolog
