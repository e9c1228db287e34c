#pragma once

#include <vector>

namespace homolog {

/// Which unknowns of a symmetric sparse matrix meet in an entry: the neighbours of unknown i are
/// neighbour[start[i]] … neighbour[start[i + 1] − 1], i itself not among them.
struct SparsityGraph {
  std::vector<int> start, neighbour;
};

/// An order of elimination: `order[k]` is the unknown that comes at place k, `position[i]` the place of unknown i.
struct Ordering {
  std::vector<int> order, position;
  bool operator==(const Ordering&) const = default;
};

/// A nested dissection [George 1973], which keeps the factor of a mesh's matrix sparse. The same graph gives the same
/// order at any time and on any thread; threads that ask at the same time wait for each other. Meanwhile METIS catches
/// SIGABRT and SIGTERM for the process; the process's own handlers are put back afterwards. Throws std::bad_alloc where
/// memory runs out, and std::runtime_error where METIS gives up, as on a SIGTERM, or where the system makes no
/// second copy of it, whose random numbers are its own.
Ordering nested_dissection(SparsityGraph graph);

}  // namespace homolog
