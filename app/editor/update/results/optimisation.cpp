#include "app/editor/update/results/optimisation.h"

#include <utility>

namespace homolog {

void start_optimisation(Editing& editing) {
  ModelsState& models = editing.state.models;
  if (!why_not_optimise(models).empty()) return;
  discard_optimised(models);
  models.optimisation.of = std::make_shared<const StudyToOptimise>(StudyToOptimise{models.fitted, models.alignment});
  editing.work.study_optimiser.start(models.optimisation.of);
}

bool update_optimisation(Editing& editing) {
  ModelsState& models = editing.state.models;
  StudyOptimiser& optimiser = editing.work.study_optimiser;
  if (!models.optimisation.runs()) {
    optimiser.cancel();
    return false;
  }
  if (const auto rounds = optimiser.take_rounds()) {
    models.optimisation.bits.clear();
    for (const GroupwiseRound& round : *rounds) models.optimisation.bits.push_back(round.bits);
  }
  models.optimisation.fraction = optimiser.fraction();
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
