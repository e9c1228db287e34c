#include "core/template_making/rasterise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/index.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/mesh_repair.h"
#include "core/mesh/remesh.h"
#include "core/mesh/voxelise.h"
#include "core/template_making/distance_map.h"
#include "core/template_making/level_set.h"

namespace homolog {
namespace {

constexpr double most_raster_voxels = 16e6;
constexpr double beyond_thick = 0.75;  ///< of half a wall: how far edges of thick parts lie beyond what a ball fills

VolumeGeometry raster_grid(const Box& box, double spacing_mm, double margin_mm) {
  const Vec3 room = box.sizes() + Vec3::Constant(2 * margin_mm);
  spacing_mm = std::max(spacing_mm, std::cbrt(room.prod() / most_raster_voxels));
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(spacing_mm);
  grid.origin_mm = box.min() - Vec3::Constant(margin_mm);
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.dims[axis] = 2 + static_cast<int>(room[static_cast<Eigen::Index>(axis)] / spacing_mm);
  return grid;
}

/// Adds to `votes` one for each voxel inside, by rays along `axis`.
void vote_along(const Mesh& mesh, const VolumeGeometry& grid, Eigen::Index axis, std::vector<std::uint8_t>& votes) {
  const std::array<Eigen::Index, 3> from{axis, (axis + 1) % 3, (axis + 2) % 3};  // old axes in their new order
  Mesh turned = mesh;
  VolumeGeometry other = grid;
  for (Eigen::Index k = 0; k < 3; ++k) {
    turned.points.col(k) = mesh.points.col(from[index(k)]);
    other.origin_mm[k] = grid.origin_mm[from[index(k)]];
    other.dims[index(k)] = grid.dims[index(from[index(k)])];
  }
  const std::vector<std::uint8_t> inside = voxelise(turned, other);
  const std::array<std::size_t, 3> stride{1, index(grid.dims[0]), index(grid.dims[0]) * index(grid.dims[1])};
  std::size_t v = 0;
  for (std::size_t k = 0; k < index(other.dims[2]); ++k)
    for (std::size_t j = 0; j < index(other.dims[1]); ++j)
      for (std::size_t i = 0; i < index(other.dims[0]); ++i, ++v)
        votes[i * stride[index(from[0])] + j * stride[index(from[1])] + k * stride[index(from[2])]] += inside[v];
}

std::vector<std::uint8_t> inside_of_parts(const Mesh& surface, const VolumeGeometry& grid) {
  std::vector<std::uint8_t> inside(grid.voxels(), 0);
  for (const Mesh& part : parts_of(surface)) {
    std::vector<std::uint8_t> votes(grid.voxels(), 0);
    for (Eigen::Index axis = 0; axis < 3; ++axis) vote_along(part, grid, axis, votes);
    for (std::size_t v = 0; v < votes.size(); ++v) inside[v] |= static_cast<std::uint8_t>(votes[v] >= 2);
  }
  return inside;
}

/// Sets the voxels that faces pass through, by points half a voxel apart at most.
void add_passed(const Mesh& surface, const VolumeGeometry& grid, std::vector<std::uint8_t>& set) {
  const Triangles& triangles = surface.topology->triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Vec3 a = grid.to_voxel(surface.points.row(triangles(f, 0))),
               b = grid.to_voxel(surface.points.row(triangles(f, 1))),
               c = grid.to_voxel(surface.points.row(triangles(f, 2)));
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(2 * longest)));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 p = a + (i * (b - a) + j * (c - a)) / n;
        set[index(std::lround(p[0])) +
            index(grid.dims[0]) * (index(std::lround(p[1])) + index(grid.dims[1]) * index(std::lround(p[2])))] = 1;
      }
  }
}

/// The voxels of walls and struts that a ball of half a wall does not fit into.
std::vector<std::uint8_t> thin_parts(const std::vector<std::uint8_t>& set, const VolumeGeometry& grid,
                                     double half_wall_mm) {
  const LevelSet solid = signed_distance(set, grid);
  std::vector<std::uint8_t> core(set.size()), thin = set;
  for (std::size_t v = 0; v < set.size(); ++v) core[v] = solid.values()[v] < -half_wall_mm;
  if (std::find(core.begin(), core.end(), 1) == core.end()) return thin;
  const std::vector<float> from_core = distance_to(core, grid);
  const double near_mm = (1 + beyond_thick) * half_wall_mm + 0.5 * grid.spacing_mm[0];
  for (std::size_t v = 0; v < set.size(); ++v)
    if (from_core[v] <= near_mm) thin[v] = 0;
  return thin;
}

}  // namespace

Rasterising rasterising_for(const Mesh& surface, int vertices) {
  const double edge_mm = spread_edge_mm(surface_area_mm2(surface), vertices);
  return {edge_mm / 4, edge_mm};
}

Volume rasterised(const Mesh& surface, const Rasterising& how) {
  const VolumeGeometry grid = raster_grid(bounds_of(surface.points), how.spacing_mm, how.wall_mm + 2 * how.spacing_mm);
  std::vector<std::uint8_t> inside = inside_of_parts(surface, grid);
  const double half_wall_mm = std::max(how.wall_mm / 2, grid.spacing_mm[0]);
  std::vector<std::uint8_t> passed = inside;
  add_passed(surface, grid, passed);
  const std::vector<std::uint8_t> thin = thin_parts(passed, grid, half_wall_mm);
  if (std::find(thin.begin(), thin.end(), 1) != thin.end()) {
    const std::vector<float> away = distance_to(thin, grid);
    // A thin part is a voxel or two thick by itself.
    const double reach_mm = half_wall_mm - 0.49 * grid.spacing_mm[0];
    for (std::size_t v = 0; v < inside.size(); ++v) inside[v] |= static_cast<std::uint8_t>(away[v] <= reach_mm);
  }
  Volume volume;
  volume.geometry = grid;
  volume.data = std::move(inside);
  volume.range_max = 1;
  return volume;
}

}  // namespace homolog
