#include "core/volume/labels/label_likeness.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

namespace homolog {

namespace {

/// The share of pairs of neighbouring voxels with a value other than 0 whose values are equal; nullopt
/// where there is no such pair.
std::optional<double> share_of_equal_neighbours(const Volume& volume) {
  const auto& dims = volume.geometry.dims;
  const auto ni = static_cast<std::size_t>(dims[0]), nj = static_cast<std::size_t>(dims[1]),
             nk = static_cast<std::size_t>(dims[2]) * static_cast<std::size_t>(volume.frames);
  std::size_t pairs = 0, equal = 0;
  std::visit(
      [&](const auto& voxels) {
        // Within a slice and to the next one. Frames follow each other as slices do.
        const auto meet = [&](std::size_t a, std::size_t b) {
          if (voxels[a] == 0 || voxels[b] == 0) return;
          ++pairs;
          equal += voxels[a] == voxels[b] ? 1 : 0;
        };
        for (std::size_t row = 0; row < nj * nk; ++row)
          for (std::size_t i = 0; i < ni; ++i) {
            const std::size_t at = row * ni + i;
            if (i + 1 < ni) meet(at, at + 1);
            if ((row + 1) % nj != 0) meet(at, at + ni);
            if (row + nj < nj * nk) meet(at, at + ni * nj);
          }
      },
      volume.data);
  return pairs == 0 ? std::nullopt : std::optional(static_cast<double>(equal) / static_cast<double>(pairs));
}

}  // namespace

LabelLikeness label_likeness(const Volume& volume) {
  const auto* real = std::get_if<std::vector<float>>(&volume.data);
  const bool whole =
      real == nullptr || std::all_of(real->begin(), real->end(), [](float v) { return v == std::floor(v); });
  if (!whole || volume.range_min < 0) return LabelLikeness::none;
  // Neighbours of one organ have one label. In images they differ by the noise: of 4 scans at most a quarter did not,
  // of 12 label maps at least 85 %, their strokes and their two-voxel walls included.
  constexpr double flat = 0.75;
  const auto equal = share_of_equal_neighbours(volume);
  if (equal && *equal < flat) return LabelLikeness::none;
  constexpr std::size_t few = 32;
  constexpr double small = 255;
  bool few_small = volume.range_max <= small;
  for (int frame = 0; frame < volume.frames && few_small; ++frame) few_small = labels_of(volume, frame).size() <= few;
  return few_small ? LabelLikeness::few_small_values : equal ? LabelLikeness::flat_parts : LabelLikeness::none;
}

bool holds_labels(const Volume& volume) {
  return label_likeness(volume) != LabelLikeness::none;
}

bool on_same_voxels(const Volume& volume, const Volume& image) {
  const auto& a = volume.geometry;
  const auto& b = image.geometry;
  return a.dims == b.dims && a.spacing_mm.isApprox(b.spacing_mm, 1e-3) && a.direction.isApprox(b.direction, 1e-3) &&
         (a.origin_mm - b.origin_mm).norm() < 0.1 * b.spacing_mm.minCoeff() &&
         (volume.frames == 1 || volume.frames == image.frames);
}

}  // namespace homolog
