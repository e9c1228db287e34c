#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/construction/icosphere.h"
#include "core/structures/maps/set_map.h"
#include "core/structures/maps/structures_in_map.h"
#include "tests/must.h"

// Five stones in a row, as the vertebrae of a spine: a template set, and a label map of another subject.

namespace homolog {

/// A ball with three axes of its own, so that no turn leaves it as it is.
inline Mesh stone_at(const Vec3& place, double radius_mm, double growth) {
  Mesh stone = icosphere(3, radius_mm);
  for (Eigen::Index v = 0; v < stone.points.rows(); ++v) {
    Vec3 p = stone.points.row(v);
    p.x() *= 1.4;
    p.z() *= 0.8;
    p += 0.15 * radius_mm * std::max(0.0, p.y() / radius_mm) * Vec3::UnitX();
    stone.points.row(v) = place + growth * p;
  }
  return stone;
}

constexpr int stones = 5;

inline Vec3 place_of(int k) {
  return {4.0 * (k % 2), 3.0 * (k % 3), 31.0 * k};
}
inline double radius_of(int k) {
  return 13 + 1.5 * k;
}
inline std::string name_of_stone(int k) {
  return "vertebrae_L" + std::to_string(k + 1);
}

/// Five stones in a row, larger downwards.
inline SetOfTemplates stone_set() {
  SetOfTemplates set;
  for (int k = 0; k < stones; ++k) {
    TemplateOfSet one;
    one.name = name_of_stone(k);
    one.value = k + 1;
    set.set.structures.push_back(one);
    const Mesh stone = stone_at(place_of(k), radius_of(k), 1);
    MeshFile file;
    file.points = stone.points;
    file.triangles = stone.topology->triangles();
    set.templates.push_back(test::must(make_template(file, one.name)));
  }
  return set;
}

/// Another subject: each a little larger, and moved. Its voxels are `voxel_mm` wide.
inline VolumeRead stone_map(double voxel_mm = 1.5) {
  VolumeGeometry grid;
  const auto across = [&](double mm) { return static_cast<int>(mm / voxel_mm); };
  grid.dims = {across(90), across(70), across(231)};
  grid.spacing_mm.setConstant(voxel_mm);
  grid.origin_mm = Vec3(-40, -32, -30);
  std::vector<MeshOfSegment> meshes;
  for (int k = 0; k < stones; ++k)
    meshes.push_back({{name_of_stone(k), k + 1, 0, {}, {}}, stone_at(1.04 * place_of(k), radius_of(k), 1.05)});
  return std::move(map_of_meshes(meshes, grid).map);
}

}  // namespace homolog
