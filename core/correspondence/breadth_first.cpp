#include "core/correspondence/colours.h"

namespace homolog {

std::vector<std::int32_t> breadth_first_rank(const Topology& topology, std::int32_t first) {
  const auto vertices = static_cast<std::int32_t>(topology.vertices());
  std::vector<std::int32_t> rank(static_cast<std::size_t>(vertices), -1), queue;
  std::size_t served = 0;
  const auto visit = [&](std::int32_t vertex) {
    std::int32_t& own = rank[static_cast<std::size_t>(vertex)];
    if (own >= 0) return;
    own = static_cast<std::int32_t>(queue.size());
    queue.push_back(vertex);
  };
  const auto search = [&](std::int32_t seed) {
    visit(seed);
    for (; served < queue.size(); ++served)
      for (const std::int32_t neighbour : topology.one_ring(queue[served])) visit(neighbour);
  };
  search(first);
  for (std::int32_t seed = 0; seed < vertices; ++seed) search(seed);  // components not reached so far
  return rank;
}

}  // namespace homolog
