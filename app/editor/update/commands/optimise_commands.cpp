#include "app/editor/update/commands/optimise_commands.h"

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/results/optimisation.h"

namespace homolog {

void StartOptimisation::run(Editing& editing) const {
  start_optimisation(editing);
}

void CancelOptimisation::run(EditorState& state) const {
  if (state.models.optimisation.runs()) discard_optimised(state.models);
}

void ShowOptimised::spell(Fields& line) {
  line.member("shown", shown);
}
void ShowOptimised::run(EditorState& state) const {
  show_optimised(state.models, shown);
}

void DiscardOptimised::run(EditorState& state) const {
  discard_optimised(state.models);
}

}  // namespace homolog
