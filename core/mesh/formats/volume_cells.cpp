#include "core/mesh/formats/volume_cells.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/mesh/formats/vertex_arrays.h"

namespace homolog::formats {
namespace {

/// A face of a tetrahedron: its corners in rising order, by which it is found again, and as seen from outside.
struct SideOfTetrahedron {
  std::array<std::int32_t, 3> sorted, seen;
};

bool is_turned(const std::int32_t* t, const std::vector<double>& x) {
  const auto at = [&](int k) { return Vec3(x.data() + 3 * static_cast<std::size_t>(t[k])); };
  return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) < 0;
}

/// The points that the faces use alone, in their order.
void keep_used_points(VolumeCells& cells, std::vector<std::int32_t>& corners, MeshFile& mesh) {
  const std::size_t all = cells.coordinates.size() / 3;
  std::vector<std::int32_t> new_index(all, -1);
  for (const std::int32_t v : corners) new_index[v] = 0;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < all; ++i) {
    if (new_index[i] < 0) continue;
    new_index[i] = static_cast<std::int32_t>(kept.size());
    kept.push_back(static_cast<Eigen::Index>(i));
  }
  for (std::int32_t& v : corners) v = new_index[v];
  mesh.points = to_points(std::move(cells.coordinates))(kept, Eigen::all);
  mesh.triangles = Eigen::Map<const Triangles>(corners.data(), std::ssize(corners) / 3, 3);
  for (auto& [name, values] : cells.arrays)
    if (values.size() == static_cast<Eigen::Index>(all)) keep_vertex_array(name, values(kept), mesh);
  mesh.warnings.push_back("holds " + std::to_string(cells.tetrahedra.size() / 4) +
                          " tetrahedra; their outside is taken, " + std::to_string(kept.size()) + " of " +
                          std::to_string(all) + " points");
}

}  // namespace

Result<void> add_tetrahedron(const std::int64_t* corners, VolumeCells& cells) {
  for (int k = 0; k < 4; ++k) {
    if (corners[k] < 0 || corners[k] > std::numeric_limits<std::int32_t>::max())
      return fail(
          "", "a tetrahedron names point " + std::to_string(corners[k]) + ", which no mesh can have; export it again");
    cells.tetrahedra.push_back(static_cast<std::int32_t>(corners[k]));
  }
  return {};
}

Error unsuited_elements(const std::string& kind) {
  return {"", "holds " + kind + "; cut them into triangles or tetrahedra with straight edges and export it again"};
}

Result<void> check_corners(const std::vector<std::int32_t>& tetrahedra) {
  std::size_t flat = 0;
  for (std::size_t t = 0; t + 4 <= tetrahedra.size(); t += 4) {
    std::array<std::int32_t, 4> corners{};
    std::copy_n(tetrahedra.data() + t, 4, corners.begin());
    std::sort(corners.begin(), corners.end());
    flat += std::adjacent_find(corners.begin(), corners.end()) != corners.end() ? 1 : 0;
  }
  if (flat == 0) return {};
  return fail("", "has " + std::to_string(flat) + " of " + std::to_string(tetrahedra.size() / 4) +
                      " tetrahedra that name a point twice, so that they are flat; mend it where it was made");
}

void drop_repeated(std::vector<std::int32_t>& tetrahedra, std::vector<std::string>& warnings) {
  using Corners = std::array<std::int32_t, 4>;
  std::vector<std::pair<Corners, std::size_t>> sorted(tetrahedra.size() / 4);
  for (std::size_t t = 0; t < sorted.size(); ++t) {
    std::copy_n(tetrahedra.data() + 4 * t, 4, sorted[t].first.begin());
    std::sort(sorted[t].first.begin(), sorted[t].first.end());
    sorted[t].second = t;
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<char> again(sorted.size(), 0);
  for (std::size_t k = 1; k < sorted.size(); ++k)
    if (sorted[k].first == sorted[k - 1].first) again[sorted[k].second] = 1;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < again.size(); ++t)
    if (again[t] == 0) std::copy_n(tetrahedra.data() + 4 * t, 4, tetrahedra.data() + 4 * kept++);
  if (kept == again.size()) return;
  warnings.push_back("lists " + std::to_string(again.size() - kept) + " of " + std::to_string(again.size()) +
                     " tetrahedra again, as for several groups; each counts once");
  tetrahedra.resize(4 * kept);
}

std::vector<std::int32_t> outer_faces(const std::vector<std::int32_t>& corners,
                                      const std::vector<double>& coordinates) {
  std::vector<SideOfTetrahedron> sides;
  sides.reserve(corners.size());
  for (std::size_t t = 0; t + 4 <= corners.size(); t += 4) {
    const std::int32_t* c = corners.data() + t;
    const bool turned = is_turned(c, coordinates);
    for (const auto& [i, j, k] : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
      SideOfTetrahedron side;
      side.seen = turned ? std::array{c[i], c[k], c[j]} : std::array{c[i], c[j], c[k]};
      side.sorted = side.seen;
      std::sort(side.sorted.begin(), side.sorted.end());
      sides.push_back(side);
    }
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const SideOfTetrahedron& a, const SideOfTetrahedron& b) { return a.sorted < b.sorted; });
  std::vector<std::int32_t> outer;
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i + 1; end < sides.size() && sides[end].sorted == sides[i].sorted;) ++end;
    if (end == i + 1) outer.insert(outer.end(), sides[i].seen.begin(), sides[i].seen.end());
  }
  return outer;
}

Result<MeshFile> surface_of(VolumeCells cells) {
  MeshFile mesh;
  mesh.warnings = std::move(cells.warnings);
  mesh.likely_cause = std::move(cells.likely_cause);
  if (auto whole = check_corners(cells.tetrahedra); !whole) mesh.likely_cause += " (it " + whole.error().what + ")";
  if (cells.tetrahedra.empty()) {
    if (auto filled = std::move(cells.faces).fill(mesh, std::move(cells.coordinates)); !filled)
      return fail(filled.error());
    for (auto& [name, values] : cells.arrays) keep_vertex_array(name, std::move(values), mesh);
  } else {
    const auto points = static_cast<std::int64_t>(cells.coordinates.size() / 3);
    for (const std::int32_t v : cells.tetrahedra)
      if (v >= points)
        return fail("", "a tetrahedron names point " + std::to_string(v) + " of " + std::to_string(points) +
                            " (counted from 0); copy or export it again");
    drop_repeated(cells.tetrahedra, mesh.warnings);
    auto corners = outer_faces(cells.tetrahedra, cells.coordinates);
    keep_used_points(cells, corners, mesh);
  }
  cells.space.apply_to(mesh);
  return mesh;
}

}  // namespace homolog::formats
