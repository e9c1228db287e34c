#include "core/template/template_mark.h"

#include <cmath>
#include <cstdint>

namespace homolog {

namespace {

/// 0.5 or 1.5, as good as random: a plain mean would stay as it is where vertices change places.
double weight_of(Eigen::Index vertex) {
  auto bits = static_cast<std::uint64_t>(vertex) * 0x9E3779B97F4A7C15ull;
  bits ^= bits >> 29;
  return (bits * 0xBF58476D1CE4E5B9ull >> 63) != 0 ? 1.5 : 0.5;
}

double rounded(double value) {
  constexpr double steps = 1e6;
  return std::round(value * steps) / steps;
}

}  // namespace

TemplateMark template_mark(const Template& the_template) {
  const auto count = static_cast<double>(the_template.points.rows());
  Vec3 place = Vec3::Zero();
  double stiffness = 0;
  for (Eigen::Index k = 0; k < the_template.points.rows(); ++k) {
    const double weight = weight_of(k) / count;
    place += weight * the_template.points.row(k).transpose();
    stiffness += weight * the_template.stiffness_base * the_template.stiffness[k];
  }
  return {rounded(place.x()), rounded(place.y()), rounded(place.z()), rounded(stiffness)};
}

Result<std::string> check_template_mark(const TemplateMark& kept, const Template& loaded) {
  const TemplateMark here = template_mark(loaded);
  // What coordinates of three decimals add up to stays below the first; a file that says 6 digits keeps the second.
  const double place_mm = 0.002 / std::sqrt(static_cast<double>(loaded.points.rows())) + 2e-6;
  constexpr double share_of_stiffness = 1e-4;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(std::abs(kept[axis] - here[axis]) <= place_mm))
      return fail(loaded.source,
                  "is another mesh than the case was made with: it has the same faces, but its vertices lie elsewhere; "
                  "put the original back or start a new case");
  if (std::abs(kept[3] - here[3]) <= share_of_stiffness * std::abs(kept[3])) return std::string();
  return loaded.source +
         ": has another stiffness than when the case was made, so that strokes may lead elsewhere; put the original "
         "back, or look at the mesh";
}

}  // namespace homolog
