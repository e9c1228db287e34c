#include "core/template_making/tube_body.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/base/numbers/index.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/voxelise.h"

namespace homolog {
namespace {

constexpr double along_grid = 0.9995;  ///< cosine of the angle to a grid's axis below which a tube runs along it
constexpr double cap_power = 3;        ///< power of the profile that closes the apex: 2 would be an ellipsoid

/// Calls `visit(i, j, k)` for every voxel of the body.
template <class Visit>
void for_each_inside(const LabelBody& region, Visit visit) {
  const auto& dims = region.grid.dims;
  std::size_t v = 0;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i)
        if (region.inside[v++] != 0) visit(i, j, k);
}

/// How far one voxel goes along a direction, to both sides of its centre.
double half_voxel_along(const VolumeGeometry& grid, const Vec3& axis) {
  return 0.5 * (grid.direction.transpose() * axis).cwiseAbs().dot(grid.spacing_mm);
}

/// The axis of the grid along which a direction runs; none where it runs across all.
std::optional<Eigen::Index> grid_axis(const VolumeGeometry& grid, const Vec3& axis) {
  for (Eigen::Index a = 0; a < 3; ++a)
    if (std::abs(grid.direction.col(a).dot(axis)) > along_grid) return a;
  return std::nullopt;
}

/// Whether the body ends at the foot of an axis of the grid with a whole slice, not with a corner or a dome. A thick
/// slice always counts as a whole.
bool ends_flat(const LabelBody& region, Eigen::Index along, const Vec3& axis) {
  const VolumeGeometry& grid = region.grid;
  if (grid.spacing_mm[along] >= thick_slices * grid.spacing_mm.minCoeff()) return true;
  const auto [first, last] = reach_along(region, axis);
  const double slice = grid.spacing_mm[along], deeper = std::max(slice, 0.1 * (last - first));
  const double area = volume_below(region, axis, first + slice) / slice;
  const double area_deeper =
      (volume_below(region, axis, first + deeper + slice) - volume_below(region, axis, first + deeper)) / slice;
  return area >= 0.5 * area_deeper;
}

/// A part of a slice's thickness, in which thick slices would show as rings; across the slices half of a voxel.
Vec3 smoothing_mm(const Vec3& voxel_mm) {
  return (0.2 * voxel_mm).cwiseMax(0.5 * voxel_mm.minCoeff());
}

/// Slices by which a body is carried on beyond its ends, so that smoothing does not reach back from there.
int slices_beyond(const VolumeGeometry& grid, Eigen::Index axis) {
  return 1 + static_cast<int>(std::ceil(3 * smoothing_mm(grid.spacing_mm)[axis] / grid.spacing_mm[axis]));
}

/// The body with its first and last slice across an axis of the grid repeated beyond them.
std::vector<std::uint8_t> carried_on(const LabelBody& region, Eigen::Index axis) {
  const auto a = static_cast<std::size_t>(axis);
  int first = region.grid.dims[a], last = -1;
  for_each_inside(region, [&](int i, int j, int k) {
    const int at = std::array{i, j, k}[a];
    first = std::min(first, at);
    last = std::max(last, at);
  });
  const int beyond = slices_beyond(region.grid, axis);
  const auto& dims = region.grid.dims;
  const std::array<std::size_t, 3> stride{1, index(dims[0]), index(dims[0]) * index(dims[1])};
  std::vector<std::uint8_t> result = region.inside;
  for_each_inside(region, [&](int i, int j, int k) {
    const std::array<int, 3> voxel{i, j, k};
    const std::size_t v = index(i) + index(j) * stride[1] + index(k) * stride[2];
    for (int n = 1; n <= beyond; ++n) {
      if (voxel[a] == first && first - n > 0) result[v - index(n) * stride[a]] = 1;
      if (voxel[a] == last && last + n + 1 < dims[a]) result[v + index(n) * stride[a]] = 1;
    }
  });
  return result;
}

/// Closes a wall that goes on beyond the apex: from half of a slice before `apex_mm` on it narrows, so that it ends
/// there. `half_mm`: half of a slice.
LevelSet closed_at_apex(const LevelSet& wall, const Vec3& axis, double apex_mm, double half_mm) {
  const VolumeGeometry& grid = wall.grid();
  std::vector<float> values = wall.values();
  const auto visit = [&](const auto& one) {
    std::size_t v = 0;
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i, ++v) one(v, grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k}).dot(axis));
  };
  double depth_mm = 0;  // depth of the last slice
  visit([&](std::size_t v, double height_mm) {
    if (std::abs(height_mm - apex_mm + half_mm) <= 0.5 * grid.spacing_mm[0] + 1e-9)
      depth_mm = std::max(depth_mm, -static_cast<double>(values[v]));
  });
  visit([&](std::size_t v, double height_mm) {
    const double share = 1 - (apex_mm - height_mm) / half_mm;  // 0 at the last slice, 1 at its outer face
    if (share <= 0) return;
    const double narrowed = share < 1 ? 1 - std::sqrt(1 - std::pow(share, cap_power)) : share * share;
    values[v] += static_cast<float>(depth_mm * narrowed);
  });
  return {grid, std::move(values)};
}

/// The largest p · axis of the samples inside; none where none is.
std::optional<double> farthest_inside(const LevelSet& wall, const Vec3& axis) {
  std::optional<double> farthest;
  const VolumeGeometry& grid = wall.grid();
  std::size_t v = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        if (wall.values()[v++] >= 0) continue;
        const double height = grid.to_mm(Vec3(i, j, k)).dot(axis);
        farthest = std::max(farthest.value_or(height), height);
      }
  return farthest;
}

}  // namespace

double TubeBody::volume_mm3() const {
  return static_cast<double>(region.body.body) * region.grid.voxel_volume_mm3();
}

Result<TubeBody> tube_body(const Volume& united, int label) {
  const Vec3& voxel_mm = united.geometry.spacing_mm;
  double margin_mm = 4 * voxel_mm.minCoeff();
  for (Eigen::Index a = 0; a < 3; ++a)
    margin_mm = std::max(margin_mm, (slices_beyond(united.geometry, a) + 2) * voxel_mm[a]);
  auto region = label_body(united, 1, 0, label_extent(united, 1, 0), voxel_mm.minCoeff(), margin_mm);
  if (!region) return fail(region.error());
  auto boundary = boundary_of(*region);
  if (!boundary) return fail(boundary.error());
  TubeBody body{std::move(*region), std::move(*boundary), {}, {}};
  body.several = several_parts(body.region, label);

  const VolumeGeometry& grid = body.region.grid;
  Vec3 centre = Vec3::Zero();
  for_each_inside(body.region, [&](int i, int j, int k) { centre += Vec3(i, j, k); });
  const auto count = static_cast<double>(body.region.body.body);
  centre /= count;
  // A voxel spreads over its own size too: of few thick slices that is much of the whole.
  Mat3 spread = (grid.spacing_mm.array().square() / 12).matrix().asDiagonal();
  for_each_inside(body.region, [&](int i, int j, int k) {
    const Vec3 p = grid.spacing_mm.cwiseProduct(Vec3(i, j, k) - centre);
    spread += p * p.transpose() / count;
  });
  body.main_axis = (grid.direction * Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(2)).normalized();
  return body;
}

std::pair<double, double> reach_along(const LabelBody& region, const Vec3& axis) {
  std::pair<double, double> reach{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for_each_inside(region, [&](int i, int j, int k) {
    const double height = region.grid.to_mm(Vec3(i, j, k)).dot(axis);
    reach = {std::min(reach.first, height), std::max(reach.second, height)};
  });
  const double half = half_voxel_along(region.grid, axis);
  return {reach.first - half, reach.second + half};
}

double volume_below(const LabelBody& region, const Vec3& axis, double end_mm) {
  const double half = half_voxel_along(region.grid, axis);
  double voxels = 0;
  for_each_inside(region, [&](int i, int j, int k) {
    const double height = region.grid.to_mm(Vec3(i, j, k)).dot(axis);
    voxels += std::clamp((end_mm - height + half) / (2 * half), 0.0, 1.0);
  });
  return voxels * region.grid.voxel_volume_mm3();
}

CentreLine::CentreLine(const LabelBody& region, const Vec3& axis) : axis_(axis) {
  const auto [first, last] = reach_along(region, axis);
  const double step = std::max(2 * half_voxel_along(region.grid, axis), (last - first) / 40);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round((last - first) / step)));
  std::vector<Vec3> sums(count, Vec3::Zero());
  std::vector<double> weights(count, 0);
  for_each_inside(region, [&, from = first, length = last - first](int i, int j, int k) {
    const Vec3 p = region.grid.to_mm(Vec3(i, j, k));
    const double at = (p.dot(axis) - from) / length * static_cast<double>(count);
    const auto bin = std::min(count - 1, static_cast<std::size_t>(std::max(0.0, at)));
    sums[bin] += p;
    weights[bin] += 1;
  });
  for (std::size_t bin = 0; bin < count; ++bin) {
    if (weights[bin] == 0) continue;
    middles_.emplace_back(sums[bin] / weights[bin]);
    heights_.push_back(middles_.back().dot(axis));
  }
}

Vec3 CentreLine::at(double height_mm) const {
  const auto above =
      static_cast<std::size_t>(std::upper_bound(heights_.begin(), heights_.end(), height_mm) - heights_.begin());
  const std::size_t b = std::min(above, heights_.size() - 1), a = above == 0 ? 0 : above - 1;
  const double length = heights_[b] - heights_[a];
  const double share = length > 0 ? std::clamp((height_mm - heights_[a]) / length, 0.0, 1.0) : 0;
  const Vec3 on = middles_[a] + share * (middles_[b] - middles_[a]);
  return on + (height_mm - on.dot(axis_)) * axis_;
}

TubeWall tube_wall(const TubeBody& body, const Vec3& axis) {
  const VolumeGeometry& grid = body.region.grid;
  const double spacing_mm = grid.spacing_mm.minCoeff();
  auto along = grid_axis(grid, axis);
  if (along && !ends_flat(body.region, *along, axis)) along.reset();
  TubeWall made;
  std::tie(made.base_mm, made.apex_mm) = reach_along(body.region, axis);
  made.flat_base = along.has_value();
  const auto inside = along ? carried_on(body.region, *along) : body.region.inside;
  made.wall = smoothed(resampled(signed_distance(inside, grid), spacing_mm), smoothing_mm(grid.spacing_mm));
  if (along)
    made.wall = closed_at_apex(made.wall, axis, made.apex_mm, 0.5 * grid.spacing_mm[*along]);
  else
    made.apex_mm = farthest_inside(made.wall, axis).value_or(made.apex_mm);
  return made;
}

Overlap overlap_of(const LabelBody& region, const Mesh& mesh) {
  // Thick voxels are cut into thin ones: half of a slice counts.
  VolumeGeometry fine = region.grid;
  std::array<int, 3> parts{};
  Vec3 first = Vec3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    parts[axis] = std::max(1, static_cast<int>(std::lround(fine.spacing_mm[a] / region.grid.spacing_mm.minCoeff())));
    fine.dims[axis] *= parts[axis];
    fine.spacing_mm[a] /= parts[axis];
    first[a] = -0.5 + 0.5 / parts[axis];
  }
  fine.origin_mm = region.grid.to_mm(first);
  const std::vector<std::uint8_t> covered = voxelise(mesh, fine);
  const auto& dims = region.grid.dims;
  double both = 0, mesh_only = 0;
  std::vector<std::uint16_t> count(region.inside.size(), 0);
  std::size_t v = 0;
  for (int k = 0; k < fine.dims[2]; ++k)
    for (int j = 0; j < fine.dims[1]; ++j)
      for (int i = 0; i < fine.dims[0]; ++i, ++v) {
        if (covered[v] == 0) continue;
        const std::size_t whole =
            index(i / parts[0]) + index(dims[0]) * (index(j / parts[1]) + index(dims[1]) * index(k / parts[2]));
        (region.inside[whole] != 0 ? both : mesh_only) += 1;
        if (count[whole] < std::numeric_limits<std::uint16_t>::max()) ++count[whole];
      }
  const int part = std::min(parts[0] * parts[1] * parts[2], int{std::numeric_limits<std::uint16_t>::max()});
  double missing = 0;
  for (std::size_t whole = 0; whole < count.size(); ++whole)
    missing += region.inside[whole] != 0 && 2 * count[whole] < part;
  const auto voxels = static_cast<double>(region.body.body), label = voxels * parts[0] * parts[1] * parts[2];
  return {both / label, mesh_only / label, missing / voxels};
}

}  // namespace homolog
