#include "core/volume/labels/soft_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace homolog {
namespace {

constexpr double exactly = 1e-3;  ///< the rest that rescaling by 32-bit floats leaves

/// Calls `see(value)` for the finite values of a frame until it gives false.
template <class See>
void for_each_finite(const Volume& volume, int frame, See see) {
  const std::size_t count = volume.geometry.voxels(), first = count * static_cast<std::size_t>(frame);
  std::visit(
      [&](const auto& values) {
        for (std::size_t v = first; v < first + count; ++v)
          if (const auto value = static_cast<double>(values[v]); std::isfinite(value) && !see(value)) return;
      },
      volume.data);
}

/// The first value that is not from 0 to `top`.
std::optional<double> value_beyond(const Volume& volume, int frame, double top) {
  std::optional<double> found;
  for_each_finite(volume, frame, [&](double value) {
    if (value < -exactly || value > top + exactly) found = value;
    return !found;
  });
  return found;
}

bool all_whole(const Volume& volume, int frame) {
  bool whole = true;
  for_each_finite(volume, frame, [&](double value) { return whole = std::abs(value - std::rint(value)) <= exactly; });
  return whole;
}

/// Works on the voxels of a soft mask that a grid has too: their numbers in both. False where their voxels do not
/// coincide.
template <class Work>
bool each_shared_voxel(const Volume& shares, const VolumeGeometry& grid, const Work& work) {
  const auto offset = offset_in_grid(grid, shares.geometry);
  if (!offset) return false;
  const auto& dims = shares.geometry.dims;
  std::size_t v = 0;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i, ++v) {
        const std::array at{i + (*offset)[0], j + (*offset)[1], k + (*offset)[2]};
        bool is_in = true;
        for (std::size_t a = 0; a < 3; ++a) is_in = is_in && at[a] >= 0 && at[a] < grid.dims[a];
        if (is_in) work(v, grid.index(at[0], at[1], at[2]));
      }
  return true;
}

/// Whether a label has the voxels that its soft mask gives it, and no other.
bool has_its_voxels(const SoftSegment& soft, const Volume& map, const VoxelBox& box) {
  const auto offset = offset_in_grid(map.geometry, soft.shares.geometry);
  if (!offset) return false;
  for (std::size_t a = 0; a < 3; ++a)
    if (box.first[a] < (*offset)[a] || box.last[a] >= (*offset)[a] + soft.shares.geometry.dims[a]) return false;
  const auto& shares = std::get<std::vector<float>>(soft.shares.data);
  bool same = true;
  std::visit(
      [&](const auto& labels) {
        each_shared_voxel(soft.shares, map.geometry, [&](std::size_t own, std::size_t at) {
          same = same && (rounded_label(shares[own]) == 1) == (rounded_label(labels[at]) == soft.value);
        });
      },
      map.data);
  return same;
}

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

bool is_soft(const Volume& mask, int frame) {
  return std::holds_alternative<std::vector<float>>(mask.data) && !value_beyond(mask, frame, 1) &&
         !all_whole(mask, frame);
}

Result<bool> make_soft(Volume& mask, int frame, double level) {
  const double top = level > 1 ? 255 : 1;
  if (const auto beyond = value_beyond(mask, frame, top))
    return fail(
        "", "holds " + brief(*beyond) + ", which is not from 0 to " + brief(top) + "; " +
                (top == 1 && *beyond > 0 ? "--level is from 0 to 1 for such masks, and above 1 for those from 0 to 255"
                                         : "leave out --level, or give a mask of one structure"));
  if (top == 1 && all_whole(mask, frame)) return false;
  std::visit(
      [&](const auto& values) {
        std::vector<float> shares(values.size());
        std::transform(values.begin(), values.end(), shares.begin(), [&](const auto value) {
          const auto real = static_cast<double>(value);
          return std::isfinite(real) ? static_cast<float>(std::clamp((real - level) / top + 0.5, 0.0, 1.0)) : 0.0F;
        });
        mask.data = std::move(shares);
      },
      VoxelData(std::move(mask.data)));
  mask.range_min = 0;
  mask.range_max = 1;
  mask.soft = true;
  return true;
}

std::optional<SoftSegment> soft_segment(const Volume& soft, int value, std::size_t layer) {
  constexpr int margin_voxels = 3;  // the surface lies within one voxel of the label
  const auto boxes = label_boxes(soft);
  const auto box = boxes.find(1);
  if (box == boxes.end()) return std::nullopt;
  SoftSegment segment{value, layer, cropped(soft, box->second, margin_voxels)};
  segment.shares.soft = true;
  return segment;
}

const SoftSegment* soft_of_label(std::span<const SoftSegment> all, const Volume& map, const VoxelBox& box, int value,
                                 std::size_t layer) {
  const auto found =
      std::ranges::find_if(all, [&](const SoftSegment& soft) { return soft.value == value && soft.layer == layer; });
  return found != all.end() && has_its_voxels(*found, map, box) ? &*found : nullptr;
}

Volume soft_on_grid(const SoftSegment& soft, const Volume& like) {
  Volume whole;
  whole.geometry = like.geometry;
  whole.modality = like.modality;
  whole.empty_beyond_slices = like.empty_beyond_slices;
  whole.range_max = 1;
  whole.soft = true;
  std::vector<float> voxels(whole.geometry.voxels());
  const auto& shares = std::get<std::vector<float>>(soft.shares.data);
  each_shared_voxel(soft.shares, whole.geometry, [&](std::size_t own, std::size_t at) { voxels[at] = shares[own]; });
  whole.data = std::move(voxels);
  return whole;
}

}  // namespace homolog
