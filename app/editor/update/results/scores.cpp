#include "app/editor/update/results/scores.h"

#include <utility>

namespace homolog {

namespace {

/// Whether the score is on the screen.
bool score_is_looked_at(const EditorState& state) {
  const auto& open = state.preferences.sections_open;
  const auto section = open.find(score_section);
  return state.look.colouring == Colouring::score || (section != open.end() && section->second);
}

/// The case itself has no part in the model that it is scored against.
void follow_study(Editing& editing) {
  const EditorState& state = editing.state;
  Scoring& scoring = editing.state.scoring;
  const Snapshot& snapshot = editing.shown.snapshot();
  const StudyCase* own = find_case(state.models, snapshot.file, *snapshot.document, state.look.structure);
  const std::string left_out = own != nullptr ? own->name : std::string();
  const auto& study = state.models.fitted.model;
  if (study == scoring.study && left_out == scoring.left_out) return;
  // Until the model is made anew, that of the same case goes on; another's would be wrong.
  if (study == nullptr || left_out != scoring.left_out) scoring.of_study.reset();
  scoring.study = study;
  scoring.left_out = left_out;
  scoring.no_model.clear();
  if (study == nullptr) return;
  editing.work.imports.queue("The model of the other cases", [study, left_out](Progress&) -> Result<Work::Then> {
    auto made = model_of_others(*study, study->index_of(left_out));
    std::shared_ptr<const ShapeModel> model;
    if (made) model = std::make_shared<const ShapeModel>(std::move(*made));
    return Work::Then([study, left_out, model, why = made ? std::string() : made.error().sentence()](Editing& then) {
      Scoring& asked = then.state.scoring;
      if (asked.study != study || asked.left_out != left_out) return;
      asked.of_study = model;
      asked.no_model = why;
    });
  });
}

}  // namespace

bool update_scores(Editing& editing) {
  EditorState& state = editing.state;
  Scoring& scoring = state.scoring;
  Work& work = editing.work;
  const bool looked_at = score_is_looked_at(state);
  if (looked_at && !scoring.by_file) follow_study(editing);
  const auto model = looked_at ? scoring.model() : nullptr;
  if (model != work.scored_by) {
    work.scored_by = model;
    work.scores.measure_by(
        [model](const Document& document, const std::string& of) { return scored_shape(model, document, of); });
  }
  work.scores.post(model ? editing.shown.displayed() : nullptr, state.look.structure);
  const bool changed = work.scores.update();
  const auto& scored = work.scores.latest();
  const auto shown = editing.shape();
  const bool is_of_shown = scored && scored->z && shown && scored->structure == state.look.structure &&
                           scored->z->size() == shown->shape.points->rows();
  scoring.z = is_of_shown ? scored->z : nullptr;
  return changed;
}

}  // namespace homolog
