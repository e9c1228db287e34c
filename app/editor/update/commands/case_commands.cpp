#include "app/editor/update/commands/case_commands.h"

#include <algorithm>
#include <cstdlib>

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/results/assistance.h"
#include "core/case/action_json.h"

namespace homolog {

namespace {

void spell_action(Fields& line, Action& action) {
  Fields::Json json = line.reads() ? Fields::Json() : to_json(action);
  line.member("action", json);
  if (!line.reads()) return;
  auto read = action_from_json(json);
  if (!read) throw Unreadable{read.error().sentence()};
  action = std::move(*read);
}

}  // namespace

void PreviewEdit::spell(Fields& line) {
  bool any = action.has_value();
  line.member("any", any);
  if (!any) return;
  if (!action) action.emplace();
  spell_action(line, *action);
}
void PreviewEdit::run(Editing& editing) const {
  if (action && works_on_structure(*action) && active_is_locked(editing.state, editing.shown.document())) return;
  editing.shown.session().preview(action, action ? assistance(editing, *action) : std::vector<Compute>{},
                                  editing.state.look.structure);
}

void ApplyEdit::spell(Fields& line) {
  spell_action(line, action);
  line.member("joined", joined);
}
void ApplyEdit::run(Editing& editing) const {
  stop_playing(editing);
  // What is placed next is what the case lacks then.
  if (std::holds_alternative<Undo>(action) || std::holds_alternative<Redo>(action)) editing.state.hand.landmark.clear();
  if (const auto* placed = std::get_if<PlaceLandmark>(&action); placed != nullptr && !placed->at)
    editing.state.hand.landmark = placed->name;
  editing.apply(action, joined);
}

void GoInHistory::spell(Fields& line) {
  line.member("steps", steps);
}
void GoInHistory::run(Editing& editing) const {
  stop_playing(editing);
  editing.state.hand.landmark.clear();
  constexpr int most = 1000;  // a list shows far fewer
  const int count = std::abs(std::clamp(steps, -most, most));
  for (int k = 0; k < count; ++k) editing.apply(steps < 0 ? Action(Undo{}) : Action(Redo{}));
}

void SnapMesh::spell(Fields& line) {
  std::optional<Vec3> at;
  double sigma_mm = region ? region->sigma_mm : 0;
  if (region) at = region->at;
  line.optional("at", at);
  line.optional("sigma_mm", sigma_mm, region.has_value());
  if (line.reads() && at) region = SnapArea{*at, sigma_mm};
  line.member("joined", joined);
}
void SnapMesh::run(Editing& editing) const {
  if (editing.refuses_edits()) return;
  const Document& document = editing.shown.document();
  if (!document.scan.image || !editing.shape())
    return add_notice(editing.state,
                      "A snap needs an image and a mesh. Open an image and place a template on the organ first.",
                      false);
  stop_playing(editing);
  editing.work.snaps.start(editing.shown.session(), region, editing.state.automatic.snap, joined,
                           editing.state.look.structure);
  if (!joined) let_shared_follow(document, editing.state.look.structure, editing.out);  // a stroke's own comes last
}

void CancelSnap::run(Editing& editing) const {
  if (!editing.work.snaps.busy()) return;
  editing.work.snaps.cancel();
  editing.log.is_done(*this);
}

void StartFit::spell(Fields& line) {
  spell_value(line, "", settings);
}
void StartFit::run(Editing& editing) const {
  if (editing.refuses_edits()) return;
  const auto& labels = editing.shown.labels();
  if (!labels.volume || !editing.shape()) return;
  if (const std::string other = labels.refusal_at(editing.shown.document().frame); !other.empty())
    return add_notice(editing.state, other, false);
  stop_playing(editing);
  FitSettings chosen = settings;
  if (chosen.label == 0 && !labels.values.empty()) chosen.label = labels.values.front();
  const Snapshot& snapshot = editing.shown.snapshot();
  ModelOfFit model;
  if (chosen.model == FitModel::file) model.model = editing.state.automatic.fit_model;
  if (chosen.model == FitModel::study) {
    model.study = editing.state.models.shapes.fitted.model;
    const StudyCase* one =
        find_case(editing.state.models, snapshot.file, *snapshot.document, editing.state.look.structure);
    if (one != nullptr) model.left_out = one->name, model.flipped = one->flipped;
  }
  if (chosen.model != FitModel::none && !model.model && !model.study)
    return add_notice(editing.state, "The model for the fit is not open any more; choose a model again.");
  editing.work.fit_seen = false;
  editing.work.started_fit = *this;
  editing.work.fitter.start_fit(snapshot.document, {labels.volume, labels.name, segmentation_of(labels)}, chosen, model,
                                editing.state.look.structure);
}

void RefineAlongSurface::run(Editing& editing) const {
  if (editing.refuses_edits()) return;
  if (!editing.shape()) return;
  stop_playing(editing);
  editing.work.started_fit.reset();
  editing.work.fitter.start_refinement(editing.shown.snapshot().document, editing.state.look.structure);
}

void cancel_fit(Editing& editing) {
  if (!editing.work.fitter.busy()) return;
  editing.work.fitter.cancel();
  editing.shown.session().preview(std::nullopt);
}

void CancelFits::run(Editing& editing) const {
  cancel_fit(editing);
  editing.work.contour_fits.cancel();
  editing.work.set_fitter.cancel();
  editing.work.propagator.cancel();
}

void PropagateFrames::run(Editing& editing) const {
  if (editing.refuses_edits()) return;
  const Document& document = editing.shown.document();
  if (!editing.shape() || !document.scan.image || document.scan.image->frames < 2) return;
  stop_playing(editing);
  editing.work.propagator.start(
      editing.shown.done(), carried_structures(editing.state.look.structures, document, editing.state.look.structure));
}

void cancel_propagation(Editing& editing) {
  editing.work.propagator.cancel();
}

void BlendModel::spell(Fields& line) {
  line.member("strength", strength);
  line.member("commit", commit);
}
void BlendModel::run(Editing& editing) const {
  if (editing.refuses_edits()) return;
  blend_model(editing, *this);
}

void CompleteByModel::run(Editing& editing) const {
  if (active_is_locked(editing.state, editing.shown.document())) return;
  if (auto complete = editing.work.model_help.completion(editing.state.automatic.model_help))
    editing.shown.session().apply_computed(std::move(complete), true, editing.state.look.structure);
}

void ShowFrame::spell(Fields& line) {
  line.member("frame", frame);
}
void ShowFrame::run(Editing& editing) const {
  if (frame != editing.shown.snapshot().document->frame) editing.state.hand.landmark.clear();
  editing.apply(SetFrame{frame});
  editing.state.look.shown_frame.reset();
}

void PlayFrames::spell(Fields& line) {
  line.member("play", play);
}
void PlayFrames::run(Editing& editing) const {
  if (play)
    editing.state.look.playing = true;
  else
    stop_playing(editing);
}

}  // namespace homolog
