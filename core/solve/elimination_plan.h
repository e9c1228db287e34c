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
/// make a front, a small dense matrix [Duff and Reid 1983; Liu 1992]. Everything is stored and counted in fours: a
/// front's pivots begin a four, and so do the rows below them; places that this leaves over belong to no unknown.
class EliminationPlan {
 public:
  struct Front {
    int first = 0, pivots = 0;  ///< the columns of L that it holds; `first` begins a four
    int rows = 0;               ///< of L below the pivots
    int parent = -1;            ///< the front that takes its update
    Eigen::Index panel = 0;     ///< how many fours of L come before its own
    Eigen::Index update = 0;    ///< how many fours of updates come before its own

    int pivot_fours() const { return (pivots + 3) / 4; }
    int row_fours() const { return (rows + 3) / 4; }
    int fours() const { return pivot_fours() + row_fours(); }
  };
  /// An entry of A's lower triangle, in the order of elimination.
  struct Entry {
    int row;    ///< at the diagonal or below it
    int place;  ///< of the row in the front of its column
    int value;  ///< which unknown it belongs to, at the diagonal; below it which edge
  };

  using Edges = std::vector<std::array<std::int32_t, 2>>;
  /// `edges`: the pairs of unknowns that meet in an entry of A, each once.
  EliminationPlan(int unknowns, const Edges& edges);

  int unknowns() const { return static_cast<int>(position_.size()); }
  int edges() const { return static_cast<int>(entries_.size()) - unknowns(); }
  /// How long a vector in the order of elimination is. Its last place belongs to no unknown.
  int places() const { return places_; }
  /// The place of each unknown in the order of elimination.
  const std::vector<int>& position() const { return position_; }

  /// Children come before their parents.
  const std::vector<Front>& fronts() const { return fronts_; }
  std::span<const int> children(int front) const { return part(children_, child_start_, front); }
  /// The rows of L below a front's pivots, ascending in the order of elimination; filled up to fours with the last
  /// place.
  std::span<const int> rows(int front) const { return part(rows_, row_start_, front); }
  /// Which rows of its parent's front they are.
  std::span<const int> places_in_parent(int front) const { return part(places_in_parent_, row_start_, front); }

  /// A's entries column by column, rows ascending from the diagonal.
  const std::vector<Entry>& entries() const { return entries_; }
  /// The entries of a column are those from its own number to the next column's.
  const std::vector<int>& entry_start() const { return entry_start_; }

  Eigen::Index panel_fours() const { return panel_fours_; }    ///< of all of L
  Eigen::Index update_fours() const { return update_fours_; }  ///< of all updates
  int most_fours() const { return most_fours_; }               ///< of any front
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

  std::vector<int> position_;
  std::vector<Front> fronts_;
  std::vector<int> children_, child_start_, rows_, places_in_parent_, row_start_;
  std::vector<Entry> entries_;
  std::vector<int> entry_start_;
  Eigen::Index panel_fours_ = 0, update_fours_ = 0, nonzeros_ = 0;
  int places_ = 0, most_fours_ = 0;
};

/// The plan for I + Λ of a mesh [docs/method.md §1]: made when it is first asked for, kept with the topology. Any
/// thread may ask.
std::shared_ptr<const EliminationPlan> elimination_plan(const Topology& topology);

}  // namespace homolog
