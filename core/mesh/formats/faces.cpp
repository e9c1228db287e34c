#include "core/mesh/formats/faces.h"

#include <limits>
#include <string>

#include "core/mesh/formats/polygons.h"

namespace homolog::formats {
namespace {

Result<void> check_indices(std::span<const std::int64_t> cell) {
  for (const std::int64_t v : cell)
    if (v < 0 || v > std::numeric_limits<std::int32_t>::max())
      return fail("", "a face names vertex " + std::to_string(v) + ", which no mesh can have; export it again");
  return {};
}

void add_strip(std::span<const std::int64_t> strip, std::vector<std::int32_t>& corners) {
  for (std::size_t i = 0; i + 2 < strip.size(); ++i) {
    const auto a = static_cast<std::int32_t>(strip[i + i % 2]), b = static_cast<std::int32_t>(strip[i + 1 - i % 2]),
               c = static_cast<std::int32_t>(strip[i + 2]);
    if (a != b && b != c && c != a) corners.insert(corners.end(), {a, b, c});
  }
}

}  // namespace

Result<void> too_many_corners() {
  return fail("", "has faces of so many corners that they cannot be cut into triangles; cut them where you export");
}

Result<void> Faces::add(std::span<const std::int64_t> polygon) {
  if (polygon.size() < 3)
    return fail("", "has a face of " + std::to_string(polygon.size()) + " corners; remove degenerate faces");
  if (polygon.size() > most_corners) return too_many_corners();
  if (auto checked = check_indices(polygon); !checked) return checked;
  if (polygon.size() > 3) polygons_.push_back({corners_.size(), 3 * (polygon.size() - 2)});
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    corners_.insert(corners_.end(), {static_cast<std::int32_t>(polygon[0]), static_cast<std::int32_t>(polygon[i]),
                                     static_cast<std::int32_t>(polygon[i + 1])});
  return {};
}

Result<void> Faces::add_cells(std::span<const std::int64_t> ends, std::span<const std::int64_t> connectivity,
                              bool strips) {
  std::int64_t start = 0;
  for (const std::int64_t end : ends) {
    if (end < start || end > static_cast<std::int64_t>(connectivity.size()))
      return fail("", "has faces whose offsets do not fit their corners; export it again");
    const auto cell = connectivity.subspan(static_cast<std::size_t>(start), static_cast<std::size_t>(end - start));
    if (auto checked = strips ? check_indices(cell) : add(cell); !checked) return checked;
    if (strips) add_strip(cell, corners_);
    start = end;
  }
  return {};
}

Result<void> Faces::fill(MeshFile& mesh, std::vector<double> coordinates) && {
  mesh.points = to_points(std::move(coordinates));
  PolygonCutter cutter(mesh.points);
  for (const Polygon& polygon : polygons_)
    if (!cutter.cut(std::span(corners_).subspan(polygon.start, polygon.count))) return too_many_corners();
  mesh.triangles = Eigen::Map<const Triangles>(corners_.data(), static_cast<Eigen::Index>(corners_.size() / 3), 3);
  return {};
}

Points to_points(std::vector<double> coordinates) {
  return Eigen::Map<const Points>(coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
}

}  // namespace homolog::formats
