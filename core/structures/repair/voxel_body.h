#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/numbers/index.h"
#include "core/structures/fitting/fit_set.h"
#include "core/template_making/distance_map.h"
#include "core/template_making/voxel_components.h"
#include "core/volume/labels/label_boxes.h"

namespace homolog {

// Voxels around a structure, as its signs and its repair look at them.

/// A set of voxels of a grid with the distances to it and to the others.
struct Body {
  std::vector<std::uint8_t> inside;
  std::vector<float> to, depth;  ///< mm: outside to it, inside to what is outside
  std::size_t voxels = 0;

  Body(std::vector<std::uint8_t> set, const VolumeGeometry& grid) : inside(std::move(set)) {
    voxels = static_cast<std::size_t>(std::ranges::count(inside, std::uint8_t{1}));
    constexpr float nowhere = 1e6F;
    to = voxels > 0 ? distance_to(inside, grid) : std::vector<float>(inside.size(), nowhere);
    std::vector<std::uint8_t> outside(inside.size());
    for (std::size_t v = 0; v < inside.size(); ++v) outside[v] = inside[v] != 0 ? 0 : 1;
    depth = voxels < inside.size() ? distance_to(outside, grid) : std::vector<float>(inside.size(), nowhere);
  }
  /// Below 0 inside.
  double signed_mm(std::size_t v) const { return inside[v] != 0 ? -depth[v] : to[v]; }
};

/// The middle of a voxel of a frame, mm.
inline Vec3 place_of_voxel(const VolumeGeometry& grid, std::size_t voxel) {
  const std::size_t row = index(grid.dims[0]), plane = row * index(grid.dims[1]);
  return grid.to_mm(Vec3(static_cast<double>(voxel % row), static_cast<double>(voxel % plane / row),
                         static_cast<double>(voxel / plane)));
}

/// The labels of a frame by places in mm, those of the nearest voxels.
class VoxelGrid {
 public:
  explicit VoxelGrid(const Volume& labels, int frame = 0)
      : labels_(labels),
        to_voxel_(labels.geometry.spacing_mm.cwiseInverse().asDiagonal() * labels.geometry.direction.inverse()),
        first_(labels.geometry.voxels() * index(frame)) {}

  /// None beyond the grid.
  std::optional<std::size_t> voxel_at(const Vec3& p_mm) const {
    const Vec3 at = (to_voxel_ * (p_mm - labels_.get().geometry.origin_mm)).array().round();
    const auto& dims = labels_.get().geometry.dims;
    for (Eigen::Index a = 0; a < 3; ++a)
      if (!(at[a] >= 0) || at[a] >= dims[a]) return std::nullopt;
    return first_ +
           labels_.get().geometry.index(static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2]));
  }
  int label_at(const Vec3& p_mm) const {
    const auto voxel = voxel_at(p_mm);
    if (!voxel) return 0;
    return std::visit([&](const auto& voxels) { return rounded_label(voxels[*voxel]); }, labels_.get().data);
  }

 private:
  std::reference_wrapper<const Volume> labels_;
  Mat3 to_voxel_;
  std::size_t first_;
};

/// The map around one structure.
struct Neighbourhood {
  VoxelBox box;
  VolumeGeometry grid;
  std::vector<int> labels;

  /// In the whole frame.
  std::size_t voxel_of_map(std::size_t v, const VolumeGeometry& map) const {
    const std::size_t row = index(grid.dims[0]), plane = row * index(grid.dims[1]);
    const std::size_t i = v % row + index(box.first[0]), j = v % plane / row + index(box.first[1]),
                      k = v / plane + index(box.first[2]);
    return map.index(i, j, k);
  }
};

inline Neighbourhood around(const Box& reach, const Volume& layer, int frame, int margin) {
  Neighbourhood there;
  there.box = voxels_around(reach, layer.geometry, margin);
  const Volume part = cropped(layer, there.box, 0, frame);
  there.grid = part.geometry;
  std::visit(
      [&](const auto& voxels) {
        for (const auto voxel : voxels) there.labels.push_back(rounded_label(voxel));
      },
      part.data);
  return there;
}

inline std::vector<std::uint8_t> voxels_with(const std::vector<int>& labels, int value) {
  std::vector<std::uint8_t> set(labels.size());
  for (std::size_t v = 0; v < labels.size(); ++v) set[v] = labels[v] == value ? 1 : 0;
  return set;
}

/// Parts of a set of voxels that have at least so many voxels; others are emptied.
inline std::vector<std::uint8_t> large_parts(std::vector<std::uint8_t> set, const VolumeGeometry& grid, double least) {
  const auto parts = connected_components(set, grid.dims, Touching::faces);
  for (std::size_t v = 0; v < set.size(); ++v)
    if (set[v] != 0 && static_cast<double>(parts.sizes[parts.part[v]]) < least) set[v] = 0;
  return set;
}

/// The label of a structure's voxels in the surroundings of another one: their label where both are of one layer, else
/// a number below 0 of its own.
int label_around(const SetInMap& subject, std::size_t of, std::size_t other);

/// The places of structures of other layers that may not overlap one; of one that is missing, those that overlap none.
class HeldByOthers {
 public:
  /// `within`: of those, the ones that may reach into a box in mm.
  HeldByOthers(const SetInMap& subject, const VolumeRead& map, int frame, std::size_t of,
               const std::optional<Box>& within = std::nullopt);
  /// The label_around of the structure that holds a place; 0: none does.
  int label_at(const Vec3& p_mm) const;
  bool empty() const { return all_.empty(); }

 private:
  struct Held {
    VoxelGrid layer;
    int value = 0, label = 0;
  };
  std::vector<Held> all_;
};

/// The map around a structure: its layer, and where nothing is there, what HeldByOthers says.
Neighbourhood around_structure(const SetInMap& subject, const VolumeRead& map, int frame, std::size_t of,
                               const Box& reach, int margin);

}  // namespace homolog
