#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace homolog {

// Measurements by name: what is measured of a shape, written once as JSON (docs/recipes.md).

/// The kinds of thing that a step of a recipe gives. One bit each, so that a member can take several.
enum class Gives : unsigned {
  point = 1,
  line = 2,
  plane = 4,
  sphere = 8,
  cylinder = 16,
  part = 32,  ///< some vertices of a structure
  section = 64,
  number = 128
};

struct StepKind;  // step_kinds.h

/// The input of a step under one key.
struct StepGiven {
  std::vector<std::size_t> steps;  ///< other steps of the recipe, by their place in it
  std::vector<double> numbers;     ///< plain numbers; the factor of a step's value if there is a step too
  std::vector<std::string> texts;
  bool flag = false;
};

/// An element or a measurement.
struct RecipeStep {
  std::string name;  ///< one written in its place is "a landmark of neck length"
  const StepKind* kind = nullptr;
  std::map<std::string, StepGiven> given;
  std::string structure;  ///< whose surface is meant; empty: the first
  std::string unit;       ///< a number's unit: "mm", "mm2", "ml", "deg", "%", "1", "image"
  bool optional = false;  ///< nothing is said where it cannot be measured
};

/// Steps refer to each other without a cycle, and each gets what it can take.
struct Recipe {
  std::string name;
  std::vector<RecipeStep> steps;
  std::vector<std::size_t> measurements;  ///< those that are reported, in their order

  /// The structures that it names, in alphabetical order.
  std::vector<std::string> structures() const;
};

/// The word of a step's kind: "distance".
std::string kind_word(const RecipeStep& step);

/// "31.2 mm", "84.0°", "1.07": a value as the window and the page of a report show it. `unit`: of its step.
std::string value_with_unit(double value, const std::string& unit);

/// Errors, without a subject: no JSON, no recipe, a newer version, an unknown word (with the nearest), a member that is
/// missing or of another type, a name that is used twice, a cycle, no measurement.
Result<Recipe> parse_recipe(std::string_view text);
/// The same of a file, which the error names.
Result<Recipe> read_recipe(const std::filesystem::path& path);

}  // namespace homolog
