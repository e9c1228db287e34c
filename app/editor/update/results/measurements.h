#pragma once

#include <string>

namespace homolog {

struct Editing;

/// Reads a recipe beside the window: the name of one that ships, or a file. The shown mesh is measured by it from then
/// on.
void choose_recipe(Editing& editing, const std::string& source);
/// Takes the recipe that is kept with another template, and gives the shown mesh to be measured where somebody looks at
/// what is measured. True where there is something new to draw.
bool update_measurements(Editing& editing);

}  // namespace homolog
