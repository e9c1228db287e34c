#include "core/adapt/doubt/roundness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// Sphericities, 1 of a ball. The femora, hips and vertebrae that were measured lie at 0.3 to 0.6, kidneys at 0.69 to
/// 0.87.
constexpr double has_features = 0.6, is_round = 0.68;

}  // namespace

double roundness(const Mesh& mesh) {
  const double volume_mm3 = 1000 * std::abs(enclosed_volume_ml(mesh)),
               of_ball_mm2 = std::cbrt(36 * std::numbers::pi * volume_mm3 * volume_mm3),
               sphericity = of_ball_mm2 / surface_area_mm2(mesh);
  return std::clamp((sphericity - has_features) / (is_round - has_features), 0.0, 1.0);
}

}  // namespace homolog
