#include "app/editor/update/results/optimisation.h"

#include <utility>

#include "app/editor/update/editing.h"

namespace homolog {

void start_optimisation(Editing& editing) {
  ModelsState& models = editing.state.models;
  if (!why_not_optimise(models).empty()) return;
  discard_optimised(models);
  models.made.optimisation.of =
      std::make_shared<const StudyToOptimise>(StudyToOptimise{models.shapes.fitted, models.made.alignment});
  editing.work.study_optimiser.start(models.made.optimisation.of);
}

bool update_optimisation(Editing& editing) {
  ModelsState& models = editing.state.models;
  StudyOptimiser& optimiser = editing.work.study_optimiser;
  if (!models.made.optimisation.runs()) {
    optimiser.cancel();
    return false;
  }
  if (const auto rounds = optimiser.take_rounds()) {
    models.made.optimisation.bits.clear();
    for (const GroupwiseRound& round : *rounds) models.made.optimisation.bits.push_back(round.bits);
  }
  models.made.optimisation.fraction = optimiser.fraction();
  auto done = optimiser.take();
  if (!done) return true;
  if (*done) {
    take_optimised(models, std::move(**done));
    editing.log.is_done(StartOptimisation{});
  } else {
    discard_optimised(models);
    add_notice(editing.state, done->error().sentence());
  }
  return true;
}

}  // namespace homolog
