#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/numbers/geometry.h"

namespace homolog {

inline constexpr double smallest_sigma_mm = 0.5, largest_sigma_mm = 200;

/// The three σ that a user switches between, small to large, in mm: shares of the placed reference's bounding-box
/// diagonal, in steps of half a millimetre. The largest moves a whole pole, the smallest only a vicinity. The scripted
/// user works with the same three. `placed_reference`: n×3, mm.
inline std::array<double, 3> default_sigmas_mm(const Points& placed_reference) {
  const double diagonal = bounds_of(placed_reference).diagonal().norm();
  const auto share = [&](double part) {
    return std::clamp(std::round(2 * part * diagonal) / 2, smallest_sigma_mm, largest_sigma_mm);
  };
  return {share(0.03), share(0.08), share(0.2)};
}

}  // namespace homolog
