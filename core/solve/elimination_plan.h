#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace homolog {

class Topology;

/// How a sparse symmetric positive definite A is brought into the form L Lᵀ: in which order its unknowns are
/// eliminated, which columns of L are worked on together, and where everything is stored. It depends on where A has
/// entries and not on their values, so a mesh needs one, made once.
///
/// The unknowns are eliminated in the order of a nested dissection. Successive columns of L with (nearly) the same rows
/// make a front, a small dense matrix [Duff and Reid 1983; Liu 1992]. While it is factorised its rows are counted in
/// fours: the pivots' begin one, and so do those below them.
class EliminationPlan {
 public:
  struct Front {
    int first = 0, pivots = 0;  ///< the columns of L that it holds
    int rows = 0;               ///< rows of L below the pivots
    int parent = -1;            ///< the front that takes its update
    Eigen::Index factor = 0;    ///< how many numbers of L come before its own
    Eigen::Index update = 0;    ///< how many fours of updates come before its own

    int pivot_fours() const { return (pivots + 3) / 4; }
    int row_fours() const { return (rows + 3) / 4; }
    int fours() const { return pivot_fours() + row_fours(); }
  };
  /// An entry of A's lower triangle, in the order of elimination.
  struct Entry {
    int row;    ///< its row, at the diagonal or below it
    int place;  ///< the row's place in the front of its column
    int value;  ///< which unknown it belongs to, at the diagonal; below it which edge
  };

  using Edges = std::vector<std::array<std::int32_t, 2>>;
  /// `edges`: the pairs of unknowns that meet in an entry of A, each once.
  EliminationPlan(int unknowns, const Edges& edges);

  int unknowns() const { return static_cast<int>(position_.size()); }
  int edges() const { return static_cast<int>(entries_.size()) - unknowns(); }
  /// The place of each unknown in the order of elimination, and the unknown at each place.
  const std::vector<int>& position() const { return position_; }
  const std::vector<int>& order() const { return order_; }

  /// Children come before their parents.
  const std::vector<Front>& fronts() const { return fronts_; }
  std::span<const int> children(int front) const { return part(children_, child_start_, front); }
  /// The places of a front: its pivots, then its rows of L below them, ascending.
  std::span<const int> places(int front) const { return part(places_, place_start_, front); }
  /// Which rows of its parent's front those below the pivots are.
  std::span<const int> places_in_parent(int front) const {
    return part(places_in_parent_, place_start_, front).subspan(fronts_[front].pivots);
  }

  /// A's entries column by column, rows ascending from the diagonal.
  const std::vector<Entry>& entries() const { return entries_; }
  /// The entries of a column are those from its own number to the next column's.
  const std::vector<int>& entry_start() const { return entry_start_; }

  Eigen::Index factor_numbers() const { return factor_numbers_; }  ///< numbers of L, as all fronts store it
  Eigen::Index update_fours() const { return update_fours_; }      ///< fours of all updates
  Eigen::Index panel_fours() const { return panel_fours_; }        ///< fours of the largest front's columns
  int most_fours() const { return most_fours_; }                   ///< fours of the longest column of any front
  /// Entries of L that may differ from zero.
  Eigen::Index nonzeros() const { return nonzeros_; }

  /// How many plans this process has made. For tests: a mesh needs one.
  static int made();

 private:
  struct Tree;
  static std::span<const int> part(const std::vector<int>& all, const std::vector<int>& start, int front) {
    return {all.data() + start[front], all.data() + start[front + 1]};
  }
  void make_fronts(const Tree& tree, const std::vector<int>& order);
  void place_entries(const Edges& edges);
  void lay_out();

  std::vector<int> position_, order_;
  std::vector<Front> fronts_;
  std::vector<int> children_, child_start_, places_, places_in_parent_, place_start_;
  std::vector<Entry> entries_;
  std::vector<int> entry_start_;
  Eigen::Index factor_numbers_ = 0, update_fours_ = 0, panel_fours_ = 0, nonzeros_ = 0;
  int most_fours_ = 0;
};

/// The plan for I + Λ of a mesh [docs/method.md §1]: made when it is first asked for, kept with the topology. Any
/// thread may ask.
std::shared_ptr<const EliminationPlan> elimination_plan(const Topology& topology);

}  // namespace homolog
