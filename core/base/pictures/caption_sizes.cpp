#include "core/base/pictures/caption_sizes.h"

#include <algorithm>
#include <cmath>

namespace homolog {

double scale_bar_mm(double mm_per_px, double longest_px) {
  const double longest_mm = mm_per_px * longest_px;
  const double power = std::pow(10, std::floor(std::log10(longest_mm)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= longest_mm) return factor * power;
  return power;
}

float caption_scale(float picture_width_px, float cell_width_px) {
  constexpr float usual_width_px = 800, least_cell_px = 180;
  return std::max(1.0f, std::min(picture_width_px / usual_width_px, cell_width_px / least_cell_px));
}

}  // namespace homolog
