#include "core/template_making/solid_voxels.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/base/numbers/index.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_repair.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/template_making/distance_map.h"
#include "core/template_making/level_set.h"

namespace homolog {
namespace {

constexpr double most_solid_voxels = 16e6;
/// Share of half a wall: a thick part's edges and corners lie so far outside of the balls of half a wall in it.
constexpr double beyond_thick = 0.75;
constexpr double thin_share = 1.25;  ///< times a wall: thinner ones grow by a wall, since a mesh shows those badly, too

double thick_wall_mm(double wall_mm, double spacing_mm) {
  return std::max(wall_mm, 2 * spacing_mm);
}

/// A grid around a box with room for walls that are made thick.
VolumeGeometry solid_grid(const Box& box, const SolidDetail& detail) {
  double spacing_mm = detail.spacing_mm;
  assert(spacing_mm > 0);
  const auto margin_mm = [&] { return thick_wall_mm(detail.wall_mm, spacing_mm) + 2 * spacing_mm; };
  const auto room_mm = [&] { return Vec3(box.sizes() + Vec3::Constant(2 * margin_mm())); };
  constexpr int most_rounds = 4000;  // a box of 1e80 mm
  for (int round = 0; round < most_rounds && (room_mm() / spacing_mm).prod() > most_solid_voxels; ++round)
    spacing_mm *= 1.05;
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(spacing_mm);
  grid.origin_mm = box.min() - Vec3::Constant(margin_mm());
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.dims[axis] = 2 + static_cast<int>(room_mm()[static_cast<Eigen::Index>(axis)] / spacing_mm);
  return grid;
}

/// The voxels of a grid around a part, which are a grid of their own.
struct PartGrid {
  std::array<int, 3> first{};
  VolumeGeometry own;
};

PartGrid part_grid(const Mesh& part, const VolumeGeometry& grid) {
  const Box box = bounds_of(part.points);
  const Vec3 low = grid.to_voxel(box.min()), high = grid.to_voxel(box.max());
  PartGrid around{{}, grid};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    around.first[axis] = std::max(0, static_cast<int>(std::floor(low[a])) - 1);
    around.own.dims[axis] = std::min(grid.dims[axis], static_cast<int>(std::ceil(high[a])) + 2) - around.first[axis];
  }
  around.own.origin_mm = grid.to_mm(Vec3(around.first[0], around.first[1], around.first[2]));
  return around;
}

/// The voxels inside by rays along `axis`, which is the grid's first axis now.
std::vector<std::uint8_t> inside_along(const Mesh& mesh, const VolumeGeometry& grid, Eigen::Index axis) {
  Mesh turned = mesh;
  VolumeGeometry other = grid;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::Index from = (axis + k) % 3;
    turned.points.col(k) = mesh.points.col(from);
    other.origin_mm[k] = grid.origin_mm[from];
    other.dims[k] = grid.dims[from];
  }
  return voxelise(turned, other);
}

/// Sets the voxels of `grid` that two of three rays say are inside the part.
void add_inside(const Mesh& part, const VolumeGeometry& grid, std::vector<std::uint8_t>& set) {
  const PartGrid around = part_grid(part, grid);
  const VolumeGeometry& own = around.own;
  const std::array<int, 3>& first = around.first;
  std::array<std::vector<std::uint8_t>, 3> along;
  for_each_in_parallel(
      3, [&](std::size_t axis) { along[axis] = inside_along(part, own, static_cast<Eigen::Index>(axis)); });
  const std::size_t ni = index(own.dims[0]), nj = index(own.dims[1]), nk = index(own.dims[2]);
  for (std::size_t k = 0; k < nk; ++k)
    for (std::size_t j = 0; j < nj; ++j) {
      const std::size_t row = grid.index(index(first[0]), index(first[1]) + j, index(first[2]) + k);
      for (std::size_t i = 0; i < ni; ++i) {
        const int votes =
            along[0][i + ni * (j + nj * k)] + along[1][j + nj * (k + nk * i)] + along[2][k + nk * (i + ni * j)];
        set[row + i] |= static_cast<std::uint8_t>(votes >= 2);
      }
    }
}

/// Sets the voxels that a face passes through, by points half a voxel apart at most: in rows along its longest edge.
void add_passed(const std::array<Vec3, 3>& corners, const VolumeGeometry& grid, std::vector<std::uint8_t>& set) {
  std::size_t longest = 0;
  const auto edge = [&](std::size_t k) { return Vec3(corners[(k + 1) % 3] - corners[k]); };
  for (std::size_t k = 1; k < 3; ++k)
    if (edge(k).squaredNorm() > edge(longest).squaredNorm()) longest = k;
  const Vec3 &a = corners[longest], &b = corners[(longest + 1) % 3], &top = corners[(longest + 2) % 3];
  const double length = (b - a).norm();
  const double height = length > 0 ? (b - a).cross(top - a).norm() / length : 0;
  const int rows = std::max(1, static_cast<int>(std::ceil(2 * height)));
  for (int row = 0; row <= rows; ++row) {
    const double up = static_cast<double>(row) / rows;
    const Vec3 from = a + up * (top - a), to = b + up * (top - b);
    const int steps = std::max(1, static_cast<int>(std::ceil(2 * (1 - up) * length)));
    for (int step = 0; step <= steps; ++step) {
      const Vec3 p = from + static_cast<double>(step) / steps * (to - from);
      set[grid.index(std::lround(p[0]), std::lround(p[1]), std::lround(p[2]))] = 1;
    }
  }
}

void add_passed(const Mesh& surface, const VolumeGeometry& grid, std::vector<std::uint8_t>& set) {
  const Triangles& triangles = surface.topology->triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    add_passed({grid.to_voxel(surface.points.row(triangles(f, 0))), grid.to_voxel(surface.points.row(triangles(f, 1))),
                grid.to_voxel(surface.points.row(triangles(f, 2)))},
               grid, set);
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

/// Adds to a solid what makes thin walls and struts of its surface thick.
void make_thick(const Mesh& surface, const VolumeGeometry& grid, double wall_mm, std::vector<std::uint8_t>& inside) {
  std::vector<std::uint8_t> passed = inside;
  add_passed(surface, grid, passed);
  // The voxels that its faces pass make a wall about one voxel thicker than it is.
  const std::vector<std::uint8_t> thin = thin_parts(passed, grid, (thin_share * wall_mm + grid.spacing_mm[0]) / 2);
  if (std::find(thin.begin(), thin.end(), 1) == thin.end()) return;
  const std::vector<float> away = distance_to(thin, grid);
  // A thin part is a voxel or two thick by itself.
  const double reach_mm = wall_mm / 2 - 0.49 * grid.spacing_mm[0];
  for (std::size_t v = 0; v < inside.size(); ++v) inside[v] |= static_cast<std::uint8_t>(away[v] <= reach_mm);
}

}  // namespace

SolidDetail solid_detail(const Mesh& surface, int vertices) {
  const double edge_mm = spread_edge_mm(surface_area_mm2(surface), vertices);
  return {edge_mm / 4, edge_mm};
}

SolidVoxels solid_voxels(const Mesh& surface, const SolidDetail& detail, Progress* progress) {
  const auto cancelled = [progress] { return progress != nullptr && progress->cancelled(); };
  const VolumeGeometry grid = solid_grid(bounds_of(surface.points), detail);
  SolidVoxels made;
  made.wall_mm = thick_wall_mm(detail.wall_mm, grid.spacing_mm[0]);
  std::vector<std::uint8_t> inside(grid.voxels(), 0);
  for (const Mesh& part : parts_of(surface))
    if (!cancelled()) add_inside(part, grid, inside);
  if (!cancelled()) make_thick(surface, grid, made.wall_mm, inside);
  made.label_map.geometry = grid;
  made.label_map.data = std::move(inside);
  made.label_map.range_max = 1;
  return made;
}

}  // namespace homolog
