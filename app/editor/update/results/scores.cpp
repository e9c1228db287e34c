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

/// The shown mesh in the open study; null: it has none of it.
const StudyCase* own_case(const Editing& editing) {
  const EditorState& state = editing.state;
  const Snapshot& snapshot = editing.shown.snapshot();
  return find_case(state.models, snapshot.file, *snapshot.document, state.look.structure);
}

/// The case itself has no part in the model that it is scored against.
void follow_study(Editing& editing) {
  const EditorState& state = editing.state;
  Scoring& scoring = editing.state.scoring;
  const StudyCase* own = own_case(editing);
  const std::string left_out = own != nullptr ? own->name : std::string();
  const auto& study = state.models.shapes.fitted.model;
  if (study == scoring.study && left_out == scoring.left_out) return;
  // Until the model is made anew, that of the same study without the same case goes on; another would be wrong.
  const bool goes_on = study != nullptr && left_out == scoring.left_out && state.models.kept.file == scoring.study_file;
  if (!goes_on) scoring.of_study.reset();
  scoring.study = study;
  scoring.study_file = state.models.kept.file;
  scoring.left_out = left_out;
  scoring.no_model.clear();
  if (study == nullptr) return editing.work.score_model.cancel();
  editing.work.score_model.start("The model of the other cases", [study, left_out](Progress&) {
    return model_of_others(*study, study->index_of(left_out));
  });
}

void take_score_model(Editing& editing) {
  Scoring& scoring = editing.state.scoring;
  const auto made = editing.work.score_model.take();
  if (!made) return;
  scoring.of_study = *made ? std::make_shared<const ShapeModel>(**made) : nullptr;
  scoring.no_model = *made ? std::string() : made->error().sentence();
}

}  // namespace

bool update_scores(Editing& editing) {
  EditorState& state = editing.state;
  Scoring& scoring = state.scoring;
  Work& work = editing.work;
  const bool looked_at = score_is_looked_at(state);
  take_score_model(editing);
  if (looked_at && !scoring.by_file) follow_study(editing);
  const auto model = looked_at ? scoring.model() : nullptr;
  // A model's shapes are those of the study, flipped ones flipped.
  const StudyCase* own = model ? own_case(editing) : nullptr;
  const bool flipped = own != nullptr && own->flipped;
  if (model != work.scored_by || flipped != work.scored_flipped) {
    work.scored_by = model;
    work.scored_flipped = flipped;
    work.scores.measure_by([model, flipped](const Document& document, const std::string& of) {
      return scored_shape(model, document, of, flipped);
    });
  }
  work.scores.post(model ? editing.shown.displayed() : nullptr, state.look.structure);
  const bool changed = work.scores.update();
  const auto& scored = work.scores.latest();
  const auto shown = editing.shape();
  const bool is_of_shown = scored && scored->z && shown && scored->structure == state.look.structure &&
                           scored->frame == shown->frame && scored->z->size() == shown->shape.points->rows();
  scoring.z = is_of_shown ? scored->z : nullptr;
  return changed;
}

}  // namespace homolog
