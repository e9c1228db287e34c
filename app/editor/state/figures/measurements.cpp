#include "app/editor/state/figures/measurements.h"

#include <array>
#include <cstdio>

#include "core/model/recipe_shapes.h"

namespace homolog {

ShapeMeasurements shape_measurements(const std::shared_ptr<const Recipe>& recipe, const Document& document,
                                     const std::string& structure) {
  const MeasuredShape shape = measured_shape(document, structure);
  Measuring measuring(*recipe, shape);
  ShapeMeasurements all{recipe, {}, {}};
  for (const std::size_t step : recipe->measurements) {
    all.numbers.push_back(measured_number(measuring, *recipe, step));
    all.lines.push_back(all.numbers.back().value ? lines_of_measurement(measuring, *recipe, step) : MeasuredLines{});
  }
  return all;
}

std::string value_with_unit(double value, const std::string& unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), unit == "1" ? "%.3f" : unit == "mm2" ? "%.0f" : "%.1f", value);
  if (unit == "1" || unit == "image") return text.data();
  if (unit == "deg") return std::string(text.data()) + "\xc2\xb0";
  return std::string(text.data()) + ' ' + (unit == "mm2" ? "mm\xc2\xb2" : unit);
}

}  // namespace homolog
