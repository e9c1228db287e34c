#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace homolog {

/// A named part of a template with a stiffness of its own (kidney: capsule 5, hilum 1) [Erdt 2009, §2.1].
struct Region {
  std::string name;
  double factor = 1;                            ///< > 0, of the stiffness base
  std::array<std::uint8_t, 3> colour{0, 0, 0};  ///< sRGB, in legends and views
  bool operator==(const Region&) const = default;
};

/// The regions of a template and which vertex is in which.
struct Regions {
  std::vector<Region> list;             ///< at most 255
  std::vector<std::uint8_t> of_vertex;  ///< 0: in none, k: in list[k − 1]; empty where `list` is empty
  bool operator==(const Regions&) const = default;
};

/// The region of a template where its scan ended: its flat face is a cut through the organ and not its boundary.
inline constexpr const char* cut_region = "cut by the scan";

/// The vertices in a region of this name, in rising order; none where there is no such region.
std::vector<std::int32_t> vertices_in(const Regions& regions, const std::string& name);
/// Adds a region; its vertices leave those they were in. None is added for no vertices or beyond 255 regions.
/// `of_vertices`: how many vertices the mesh has.
void add_region(Regions& regions, Region region, const std::vector<std::int32_t>& vertices, std::size_t of_vertices);

}  // namespace homolog
