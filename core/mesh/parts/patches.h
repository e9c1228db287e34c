#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// The vertices reached from `seed` over edges, each of which `joins(vertex)`; `seed` first.
template <class Joins>
std::vector<std::int32_t> flood(const Topology& topology, std::int32_t seed, const Joins& joins) {
  std::vector<char> seen(static_cast<std::size_t>(topology.vertices()), 0);
  std::vector<std::int32_t> reached{seed};
  seen[seed] = 1;
  for (std::size_t next = 0; next < reached.size(); ++next)
    for (const std::int32_t n : topology.one_ring(reached[next])) {
      if (seen[n] != 0 || !joins(n)) continue;
      seen[n] = 1;
      reached.push_back(n);
    }
  return reached;
}

/// The vertices for which `marked` holds (n values), in patches that hang together over edges; each in rising order,
/// the patches by their first vertices.
std::vector<std::vector<std::int32_t>> patches_of(const Topology& topology, std::vector<char> marked);

}  // namespace homolog
