#include "core/volume/labels/soft_mask.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace homolog {
namespace {

constexpr double exactly = 1e-3;  ///< what rescaling by 32-bit floats leaves

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

}  // namespace homolog
