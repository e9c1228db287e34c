#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/case/document.h"
#include "core/measure/recipe/measured_lines.h"
#include "core/measure/recipe/recipe.h"

namespace homolog {

/// The title of the section that lists what a recipe measures.
inline constexpr const char* measurements_section = "Measurements";

/// By which recipe the shown mesh is measured.
struct Measurements {
  std::string source;                    ///< the name of a recipe that ships, or a file; empty: none
  std::shared_ptr<const Recipe> recipe;  ///< null: none, or it is not read yet
  bool chosen = false;                   ///< by a person, or the case was left with it; else it is the template's
  std::string of_template;               ///< the source of the template that a recipe was looked for beside
  std::set<std::string> drawn;           ///< the measurements that are drawn on the mesh, by their names
};

/// The measurements that a recipe gives of a mesh: for each of its measurements, in their order.
struct ShapeMeasurements {
  std::shared_ptr<const Recipe> recipe;
  std::vector<MeasuredNumber> numbers;
  std::vector<MeasuredLines> lines;  ///< empty where there is no number
  bool operator==(const ShapeMeasurements&) const = default;
};
/// Measures the structure of an id, which has a mesh at the document's frame.
ShapeMeasurements shape_measurements(const std::shared_ptr<const Recipe>& recipe, const Document& document,
                                     const std::string& structure);

}  // namespace homolog
