#include "app/editor/update/commands/measurement_commands.h"

#include "core/case/actions/fields.h"

namespace homolog {

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
