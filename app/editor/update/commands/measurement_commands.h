#pragma once

#include <string>

#include "app/editor/update/commands/logged.h"
#include "app/editor/update/commands/looks/setting.h"
#include "app/editor/update/results/measurements.h"

namespace homolog {

class Fields;
struct Editing;

// Measurements of the shown mesh by a recipe.

/// Measures by another recipe: the name of one that ships, or a file.
using ChooseRecipe = EditingCallLogged<Logged::when_done, "choose recipe", "source", choose_recipe>;
/// Draws a measurement on the mesh, or no more.
struct DrawMeasurement {
  static constexpr const char* key = "draw measurement";
  std::string name;
  bool drawn = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};

}  // namespace homolog
