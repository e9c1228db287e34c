#include "core/mesh/parts/patches.h"

#include <algorithm>

namespace homolog {

std::vector<std::vector<std::int32_t>> patches_of(const Topology& topology, std::vector<char> marked) {
  std::vector<std::vector<std::int32_t>> patches;
  for (std::size_t seed = 0; seed < marked.size(); ++seed) {
    if (marked[seed] == 0) continue;
    auto patch = flood(topology, static_cast<std::int32_t>(seed), [&](std::int32_t v) { return marked[v] != 0; });
    for (const std::int32_t v : patch) marked[v] = 0;
    std::sort(patch.begin(), patch.end());
    patches.push_back(std::move(patch));
  }
  return patches;
}

}  // namespace homolog
