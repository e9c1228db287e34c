#pragma once

#include <string>
#include <vector>

#include "core/measure/recipe/measuring.h"
#include "core/measure/recipe/recipe.h"

namespace homolog {

/// The kind of value under a key of a step.
enum class Takes {
  steps,    ///< elements, by name or written in their place
  number,   ///< plain
  length,   ///< mm, or {"times": 2, "of": "a measurement"}
  numbers,  ///< a list
  whole_numbers,
  text,
  texts,  ///< one or a list
  flag
};

/// A key of a step.
struct StepMember {
  const char* key;
  Takes takes = Takes::steps;
  unsigned accepts = 0;              ///< the kinds of value that steps may give
  std::size_t least = 1, most = 1;   ///< how many; 0: the key may be left out
  std::vector<const char*> words{};  ///< the texts allowed; empty: anything
};

using MeasureStep = Result<StepValue>(Measuring& measuring, const RecipeStep& step);

/// The lines that show a measurement on its shape [measured_lines.h].
enum class Draws {
  nothing,   ///< it is of no points, or no number
  distance,  ///< from `from` to `to`
  along,     ///< the same, as far as it goes along an axis
  angle,     ///< the arms `from`, `at` and `to`, or both of `between`
  value,     ///< the circles, the axis or the outline of `of`
  way,       ///< over the surface, `through` points
  extent,    ///< as far as `of` reaches `along` a line
  area,      ///< the outline of `of` where that is a section
  parts      ///< what the measurements in `of` draw
};

/// A kind of step. A word may have several, told apart by their keys.
struct StepKind {
  const char* word;
  Gives gives;
  const char* unit;  ///< of a number; "": that of the steps that it is made of
  Draws draws;
  std::vector<StepMember> members;
  MeasureStep* measure;
};

/// The kinds by what they give.
const std::vector<StepKind>& point_kinds();
const std::vector<StepKind>& fit_kinds();     ///< lines, planes, spheres, cylinders, sections
const std::vector<StepKind>& part_kinds();    ///< vertices of a structure
const std::vector<StepKind>& length_kinds();  ///< numbers that need no area
const std::vector<StepKind>&
surface_kinds();  ///< numbers of surfaces: areas, volumes, thickness, an image along normals
/// All of them.
std::vector<const StepKind*> step_kinds();

/// How far a part or a section of an `extent` reaches along its line.
struct ExtentAlong {
  double low_mm = 0, high_mm = 0;  ///< from where the line's direction has 0, through the origin
  Vec3 middle = Vec3::Zero();      ///< the mean of its points
};
/// Errors: the shape lacks the structure.
Result<ExtentAlong> extent_along(const Measuring& measuring, const RecipeStep& step);

constexpr unsigned bits(Gives gives) {
  return static_cast<unsigned>(gives);
}
inline constexpr unsigned any_axis = bits(Gives::line) | bits(Gives::cylinder);
inline constexpr std::size_t many = 100'000;

}  // namespace homolog
