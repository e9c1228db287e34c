#include "core/volume/labels/label_boxes.h"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/index.h"

namespace homolog {

std::map<int, VoxelBox> label_boxes(const Volume& label_map, int frame) {
  const auto& dims = label_map.geometry.dims;
  std::map<int, VoxelBox> boxes;
  std::visit(
      [&](const auto& voxels) {
        std::size_t at = label_map.geometry.voxels() * index(frame);
        for (int k = 0; k < dims[2]; ++k)
          for (int j = 0; j < dims[1]; ++j)
            for (int i = 0; i < dims[0]; ++i, ++at) {
              const int value = rounded_label(voxels[at]);
              if (value == 0) continue;
              const std::array<int, 3> here{i, j, k};
              VoxelBox& box = boxes.try_emplace(value, VoxelBox{here, here}).first->second;
              for (std::size_t a = 0; a < 3; ++a) {
                box.first[a] = std::min(box.first[a], here[a]);
                box.last[a] = std::max(box.last[a], here[a]);
              }
            }
      },
      label_map.data);
  return boxes;
}

namespace {

/// A box in mm as one in voxels.
Box in_voxels(const Box& box_mm, const VolumeGeometry& grid) {
  Box box;
  for (int corner = 0; corner < 8; ++corner)
    box.extend(grid.to_voxel(box_mm.corner(static_cast<Box::CornerType>(corner))));
  return box;
}

}  // namespace

VoxelBox voxels_around(const Box& box_mm, const VolumeGeometry& grid, int margin) {
  const Box box = in_voxels(box_mm, grid);
  VoxelBox voxels;
  for (std::size_t a = 0; a < 3; ++a) {
    const double most = grid.dims[a] - 1, axis = static_cast<double>(margin);
    const auto e = static_cast<Eigen::Index>(a);
    voxels.first[a] = static_cast<int>(std::clamp(std::floor(box.min()[e]) - axis, 0.0, most));
    voxels.last[a] = static_cast<int>(std::clamp(std::ceil(box.max()[e]) + axis, 0.0, most));
  }
  return voxels;
}

VolumeGeometry grid_over(const VolumeGeometry& grid, const Box& box_mm) {
  constexpr double rounding = 1e-6;
  const Box box = in_voxels(box_mm, grid);
  VoxelBox whole;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto e = static_cast<Eigen::Index>(a);
    whole.first[a] = std::min(0, static_cast<int>(std::floor(box.min()[e] + 0.5 + rounding)));
    whole.last[a] = std::max(grid.dims[a] - 1, static_cast<int>(std::ceil(box.max()[e] - 0.5 - rounding)));
  }
  return part_of_grid(grid, whole);
}

std::optional<std::array<int, 3>> offset_in_grid(const VolumeGeometry& grid, const VolumeGeometry& other) {
  constexpr double farthest = 1e8;
  const Vec3 first = grid.to_voxel(other.origin_mm).array().round();
  if (!(first.cwiseAbs().maxCoeff() < farthest)) return std::nullopt;
  VolumeGeometry moved = grid;
  moved.dims = other.dims;
  moved.origin_mm = grid.to_mm(first);
  if (!same_grid(moved, other)) return std::nullopt;
  const Eigen::Vector3i whole = first.cast<int>();
  return std::array{whole[0], whole[1], whole[2]};
}

VolumeGeometry part_of_grid(const VolumeGeometry& grid, const VoxelBox& box) {
  VolumeGeometry part = grid;
  for (std::size_t a = 0; a < 3; ++a) part.dims[a] = box.last[a] - box.first[a] + 1;
  part.origin_mm = grid.to_mm(Vec3(box.first[0], box.first[1], box.first[2]));
  return part;
}

Volume cropped(const Volume& volume, const VoxelBox& box, int margin, int frame) {
  const auto& dims = volume.geometry.dims;
  VoxelBox wide = box;
  for (std::size_t a = 0; a < 3; ++a) {
    wide.first[a] = std::max(0, box.first[a] - margin);
    wide.last[a] = std::min(dims[a] - 1, box.last[a] + margin);
  }
  Volume part;
  part.geometry = part_of_grid(volume.geometry, wide);
  part.modality = volume.modality;
  part.empty_beyond_slices = volume.empty_beyond_slices;
  std::visit(
      [&](const auto& voxels) {
        std::decay_t<decltype(voxels)> kept;
        kept.reserve(part.geometry.voxels());
        const std::size_t start = volume.geometry.voxels() * index(frame);
        for (int k = wide.first[2]; k <= wide.last[2]; ++k)
          for (int j = wide.first[1]; j <= wide.last[1]; ++j) {
            const std::size_t row = start + volume.geometry.index(0, j, k);
            const auto from = voxels.begin() + static_cast<std::ptrdiff_t>(row);
            kept.insert(kept.end(), from + wide.first[0], from + wide.last[0] + 1);
          }
        const auto [low, high] = std::minmax_element(kept.begin(), kept.end());
        part.range_min = static_cast<double>(*low);
        part.range_max = static_cast<double>(*high);
        part.data = std::move(kept);
      },
      volume.data);
  return part;
}

}  // namespace homolog
