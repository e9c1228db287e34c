#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/verbs/measure/measure_recipe.h"
#include "core/model/shapes/recipe_shapes.h"

namespace homolog {

/// One shape, measured.
struct MeasuredCase {
  std::string name;
  std::string file;   ///< as ReadShape names it
  std::string group;  ///< of a study's case; empty: none
  std::optional<int> frame;
  std::vector<MeasuredNumber> values;
};

/// What was measured by a recipe.
struct MeasuredByRecipe {
  Recipe recipe;
  std::vector<MeasuredCase> cases;
  std::vector<ModeValues> modes;  ///< of the model, where one is measured too
};

/// The report, with a row for each measurement, shape and mode; the table is written where the job names one. Errors:
/// the table's file.
Result<Report> report_of_measured(const RecipeJob& job, const MeasuredByRecipe& measured,
                                  std::vector<std::string> warnings);

}  // namespace homolog
