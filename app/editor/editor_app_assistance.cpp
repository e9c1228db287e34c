#include "app/editor/editor_app.h"

// The automatic steps on the open case: the fit to a label, and the help of the study's model.

namespace homolog {

namespace {

/// Takes back what the model did.
Result<std::optional<Action>> without_help(const Document& document) {
  if (!document.has_shape() || !document.shape().unaided) return std::optional<Action>();
  return std::optional<Action>(points_edit(document, unaided_points(document.shape()), by_model));
}

}  // namespace

void EditorApp::cancel_fit() {
  if (!fitter_.busy()) return;
  fitter_.cancel();
  session_->preview(std::nullopt);
}

void EditorApp::follow_fit() {
  if (fitter_.document() && fitter_.document() != snapshot_->document) {
    cancel_fit();
    add_notice(state_, "The case was edited while the fit ran, so the fit was given up.", false);
  }
  if (auto step = fitter_.take_step(); step && fitter_.busy()) {
    // The organ may be far from where the template was.
    if (!std::exchange(fit_seen_, true)) look_at_mesh(state_, *step);
    session_->preview(SetPoints{"fit", std::nullopt, std::move(step)});
  }
  if (auto done = fitter_.take()) {
    if (*done) return take_fit(std::move(**done));
    session_->preview(std::nullopt);
    add_notice(state_, done->error().sentence());
  }
}

void EditorApp::take_fit(Fitted fitted) {
  if (fitted.edit.by == by_refinement) {
    for (const std::string& remark : fitted.remarks) add_notice(state_, remark, false);
  } else {
    look_at_mesh(state_, *fitted.edit.points);
    state_.last_fit = fitted;
  }
  session_->apply(std::move(fitted.edit));
}

void EditorApp::follow_learning() {
  for (const std::string& sentence : study_appearance_.update()) add_notice(state_, sentence, false);
  const Document& document = *snapshot_->document;
  auto cases = cases_to_learn(state_.models.study, snapshot_->file);
  if (!state_.snap.learn || !document.reference || cases.empty())
    study_appearance_.forget();
  else
    study_appearance_.ask(std::move(cases), document.reference->topology->vertices());
  state_.snap.learned = study_appearance_.learned().appearance;
}

std::vector<Compute> EditorApp::assistance(const Action& action) const {
  std::vector<Compute> then;
  const auto* stroke = std::get_if<Stroke>(&action);
  if (stroke == nullptr || !moves_boundary(stroke->tool)) return then;
  if (state_.snap.with_strokes && displayed_->volume)
    then.push_back(snap_compute(snap_region(*displayed_, *stroke), state_.snap));
  if (auto complete = model_help_.completion(state_.model_help)) then.push_back(std::move(complete));
  return then;
}

void EditorApp::ask_model() {
  const StudyCase* one = find_case(state_.models, snapshot_->file, snapshot_->document->frame);
  model_help_.ask(state_.models.model, one != nullptr ? one->name : std::string());
}

void EditorApp::blend_model(const BlendModel& command) {
  if (!state_.models.model || !snapshot_->document->has_shape()) return;
  ask_model();
  state_.model_help = command.strength;
  auto complete = model_help_.completion(command.strength);
  if (command.strength <= 0) complete = without_help;
  if (!complete) {
    session_->preview(std::nullopt);
    blend_wanted_ = command;
    return;
  }
  blend_wanted_.reset();
  if (command.commit)
    session_->apply_computed(std::move(complete));
  else
    session_->preview(std::nullopt, {std::move(complete)});
}

void EditorApp::follow_model_help() {
  if (const auto error = model_help_.update()) {
    add_notice(state_, *error);
    blend_wanted_.reset();
    state_.model_help = 0;
  }
  if (state_.model_help <= 0) return;
  const Document& document = *snapshot_->document;
  if (!state_.models.model || !document.has_shape() ||
      state_.models.model->landmarks() != document.reference->topology->vertices()) {
    state_.model_help = 0;
    return;
  }
  ask_model();  // the study may have grown
  if (blend_wanted_ && !model_help_.busy()) blend_model(BlendModel(*blend_wanted_));
}

}  // namespace homolog
