#include "core/mesh/parts/regions.h"

#include <algorithm>
#include <utility>

namespace homolog {

std::vector<std::int32_t> vertices_in(const Regions& regions, const std::string& name) {
  std::vector<std::int32_t> vertices;
  const auto found = std::ranges::find(regions.list, name, &Region::name);
  if (found == regions.list.end()) return vertices;
  const auto number = found - regions.list.begin() + 1;
  for (std::size_t i = 0; i < regions.of_vertex.size(); ++i)
    if (regions.of_vertex[i] == number) vertices.push_back(static_cast<std::int32_t>(i));
  return vertices;
}

void add_region(Regions& regions, Region region, const std::vector<std::int32_t>& vertices, std::size_t of_vertices) {
  constexpr std::size_t most = 255;
  if (vertices.empty() || regions.list.size() >= most) return;
  regions.of_vertex.resize(of_vertices, 0);
  regions.list.push_back(std::move(region));
  for (const std::int32_t i : vertices) regions.of_vertex[i] = static_cast<std::uint8_t>(regions.list.size());
}

}  // namespace homolog
