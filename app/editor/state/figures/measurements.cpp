#include "app/editor/state/figures/measurements.h"

#include "core/model/shapes/recipe_shapes.h"

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

}  // namespace homolog
