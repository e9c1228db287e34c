#include "render/hued_shapes.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace homolog {

namespace {

/// Half of the angle at which a camera without perspective shows its target.
constexpr double half_angle = 15 * std::numbers::pi / 180;

}  // namespace

double distance_that_shows(double radius_mm) {
  return radius_mm / std::tan(half_angle);
}

double shown_radius_mm(const Camera3D& camera) {
  return camera.distance_mm * std::tan(half_angle);
}

std::shared_ptr<const std::vector<Rgb>> hued_surface(const std::vector<float>& hues) {
  std::vector<Rgb> colours;
  colours.reserve(hues.size());
  for (const float hue : hues) colours.push_back(hsv_to_rgb(hue, 0.4f, 1));
  return std::make_shared<const std::vector<Rgb>>(std::move(colours));
}

void add_hued_glyphs(GlyphLayer& layer, const Points& points, const std::vector<std::int32_t>& vertices,
                     const std::vector<float>& hues, double radius_mm) {
  for (const std::int32_t i : vertices)
    layer.glyphs.push_back({points.row(i), hsv_to_rgb(hues[i], 1, 1), static_cast<float>(radius_mm)});
}

}  // namespace homolog
