#include "app/editor/update/commands/measurement_commands.h"

#include "app/editor/update/editing.h"
#include "app/editor/update/results/measurements.h"
#include "core/case/actions/fields.h"

namespace homolog {

void ChooseRecipe::spell(Fields& line) {
  line.member("source", source);
}
void ChooseRecipe::run(Editing& editing) const {
  choose_recipe(editing, source);
}

void DrawMeasurement::spell(Fields& line) {
  line.member("name", name);
  line.member("drawn", drawn);
}
void DrawMeasurement::run(EditorState& state) const {
  if (drawn)
    state.measurements.drawn.insert(name);
  else
    state.measurements.drawn.erase(name);
}

}  // namespace homolog
