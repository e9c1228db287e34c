#include "core/mesh/regions.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <utility>

namespace homolog {

std::string hex_of(const std::array<std::uint8_t, 3>& colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

std::optional<std::array<std::uint8_t, 3>> colour_from_hex(const std::string& text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    const char* from = text.data() + 1 + 2 * c;
    if (std::from_chars(from, from + 2, colour[c], 16).ptr != from + 2) return std::nullopt;
  }
  return colour;
}

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
  for (const std::int32_t i : vertices)
    regions.of_vertex[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(regions.list.size());
}

}  // namespace homolog
