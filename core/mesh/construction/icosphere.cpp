#include "core/mesh/construction/icosphere.h"

#include <array>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace homolog {

Mesh icosphere(int level, double radius_mm, const Vec3& centre) {
  const double g = std::numbers::phi;
  std::vector<Vec3> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                           {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::int32_t, 3>> faces{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> halves;
    const auto half = [&](std::int32_t a, std::int32_t b) {
      const auto [at, added] = halves.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(points.size()));
      if (added) points.push_back((points[a].normalized() + points[b].normalized()));
      return at->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::int32_t ab = half(a, b), bc = half(b, c), ca = half(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  for (Vec3& p : points) p = centre + radius_mm * p.normalized();
  Mesh sphere;
  sphere.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    sphere.points.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    triangles.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  sphere.topology = Topology::make(sphere.points.rows(), std::move(triangles)).value();
  return sphere;
}

}  // namespace homolog
