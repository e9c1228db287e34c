#pragma once

#include <vector>

#include "core/measure/recipe/measuring.h"

namespace homolog {

/// The lines that show a measurement on its shape. Empty of one that is of no points: an area, a volume, a thickness.
struct MeasuredLines {
  std::vector<std::vector<Vec3>> lines;  ///< LPS mm, two points or more each
  Vec3 at = Vec3::Zero();                ///< beside which its value is written
  bool operator==(const MeasuredLines&) const = default;
};

/// The lines of a measurement that could be taken: a distance from point to point, the arms of an angle, a fit's
/// circles and axis, a way over the surface, a section. Axes and planes are drawn about a quarter of the shape long.
MeasuredLines lines_of_measurement(Measuring& measuring, const Recipe& recipe, std::size_t step);

}  // namespace homolog
