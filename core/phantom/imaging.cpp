#include "core/phantom/imaging.h"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/random.h"

namespace homolog::phantom {

std::vector<float> slice_grain(int width, int height, std::uint64_t seed, std::uint64_t index) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  const std::uint64_t key = mix_bits(seed + mix_bits(index));
  std::vector<float> white((w + 2) * (h + 2)), across(w * (h + 2)), grain(w * h);
  for (std::size_t n = 0; n < white.size(); ++n) white[n] = static_cast<float>(normal_of(mix_bits(key + n)));
  for (std::size_t j = 0; j < h + 2; ++j)
    for (std::size_t i = 0; i < w; ++i) {
      const float* row = &white[j * (w + 2) + i];
      across[j * w + i] = row[0] + 2 * row[1] + row[2];
    }
  const float unit_deviation = 1.0F / 6.0F;  // the weights 1 2 1 by 1 2 1 have the norm 6
  for (std::size_t n = 0; n < grain.size(); ++n)
    grain[n] = (across[n] + 2 * across[n + w] + across[n + 2 * w]) * unit_deviation;
  return grain;
}

VolumeGeometry grid_over(const Box& box, double spacing_mm, double usual_mm) {
  VolumeGeometry grid;
  const double spacing = spacing_mm > 0 ? std::max(spacing_mm, 0.25) : usual_mm;
  grid.spacing_mm.setConstant(spacing);
  for (int axis = 0; axis < 3; ++axis)
    grid.dims[axis] = std::max(1, static_cast<int>(std::lround(box.sizes()[axis] / spacing)));
  grid.origin_mm = box.min().array() + spacing / 2;
  return grid;
}

void note_range(Volume& volume) {
  std::visit(
      [&](const auto& voxels) {
        const auto [low, high] = std::minmax_element(voxels.begin(), voxels.end());
        volume.range_min = static_cast<double>(*low);
        volume.range_max = static_cast<double>(*high);
      },
      volume.data);
}

Volume ct_image(const VolumeGeometry& grid, const std::function<double(const Vec3& p_mm)>& hounsfield, double noise_hu,
                std::uint64_t seed, const Progress* progress) {
  Volume image;
  image.geometry = grid;
  image.modality = "CT";
  std::vector<std::int16_t> voxels(grid.voxels());
  auto voxel = voxels.begin();
  for (int k = 0; k < grid.dims[2] && !is_cancelled(progress); ++k) {
    const auto grain = slice_grain(grid.dims[0], grid.dims[1], seed, static_cast<std::uint64_t>(k));
    auto grain_here = grain.begin();
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const double value = hounsfield(grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k})) + noise_hu * *grain_here++;
        *voxel++ = static_cast<std::int16_t>(std::lround(std::clamp(value, -1024.0, 3071.0)));
      }
  }
  image.data = std::move(voxels);
  note_range(image);
  return image;
}

}  // namespace homolog::phantom
