#include "app/editor/update/results/assistance.h"

#include <cmath>
#include <utility>

#include "app/editor/state/views.h"
#include "core/deform/stroke_kinds.h"
#include "core/mesh/mesh_quality.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

/// Takes back what the model did.
Result<std::optional<Action>> without_help(const Document& document, const std::string& of) {
  const auto shown = document.view(of);
  if (!shown || !shown->shape.unaided) return std::optional<Action>();
  return std::optional<Action>(points_edit(*shown, unaided_points(shown->shape), FoundBy::model));
}

void take_fit(Editing& editing, Fitted fitted) {
  EditorState& state = editing.state;
  if (editing.refuses_edits()) return editing.shown.session().preview(std::nullopt);  // it was locked meanwhile
  if (fitted.edit.by == FoundBy::refinement) {
    for (const std::string& remark : fitted.figures.remarks) add_notice(state, remark, false);
    state.found.last_refinement = fitted;
    editing.log.is_done(RefineAlongSurface{});
  } else {
    look_at_mesh(state, *fitted.edit.points);
    state.found.last_fit = fitted;
    if (editing.work.started_fit) editing.log.is_done(*editing.work.started_fit);
  }
  const bool is_fit = fitted.edit.by == FoundBy::fit;
  Note figures{"fit", {}, {}, fitted.figures};
  editing.apply(std::move(fitted.edit));
  if (is_fit) editing.apply(std::move(figures), true);
  let_shared_follow(editing.shown.document(), state.look.structure, editing.out);
}

void ask_model(Editing& editing) {
  const Snapshot& snapshot = editing.shown.snapshot();
  const StudyCase* one =
      find_case(editing.state.models, snapshot.file, *snapshot.document, editing.state.look.structure);
  editing.work.model_help.ask(editing.state.models.shapes.fitted.model, one != nullptr ? one->name : std::string(),
                              one != nullptr && one->flipped);
}

/// Once the edit of a snap is made; of one that was refused nothing is said.
void say_what_is_held(Editing& editing) {
  auto& snapped = editing.state.found.snapped;
  if (!snapped || snapped->held.empty() || snapped->told) return;
  const auto done = active_shape(editing.state, *editing.shown.snapshot().document);
  const bool made = done && done->shape.strokes >= snapped->strokes;
  if (!made && !editing.shown.at_rest()) return;
  snapped->told = true;
  if (made) add_notice(editing.state, "Snap: held " + snapped->held + " where you put them.", false);
}

}  // namespace

SnapArea snap_region(const ShapeView& shown, const Stroke& stroke) {
  const double edge_mm = mean_edge_mm(*shown.the_template().topology, *shown.shape.points);
  return {stroke.to, std::hypot(stroke.sigma_mm, stiffness_length_mm(shown.paint().base, edge_mm))};
}

std::vector<Compute> assistance(const Editing& editing, const Action& action) {
  std::vector<Compute> then;
  if (const auto* drawn = std::get_if<SetContours>(&action); drawn != nullptr && drawn->curves)
    then.push_back(contour_compute());
  const auto* stroke = std::get_if<Stroke>(&action);
  if (stroke == nullptr || !kind_of_stroke(stroke->tool).moves_boundary) return then;
  const auto shown = editing.shape();
  if (shown && editing.state.automatic.snap.with_strokes && editing.shown.document().scan.image)
    then.push_back(snap_compute(snap_region(*shown, *stroke), editing.state.automatic.snap));
  if (auto complete = editing.work.model_help.completion(editing.state.automatic.model_help))
    then.push_back(std::move(complete));
  return then;
}

void update_fit(Editing& editing) {
  Fitter& fitter = editing.work.fitter;
  SessionThread& session = editing.shown.session();
  const bool of_another = fitter.of() != editing.state.look.structure;
  if (fitter.document() && (of_another || fitter.document() != editing.shown.snapshot().document)) {
    fitter.cancel();  // also one that has just ended
    session.preview(std::nullopt);
    add_notice(editing.state, "The fit was stopped by an edit, another frame or another case. Start it again.", false);
    return;
  }
  if (!fitter.busy() && !editing.shown.at_rest()) return;  // an edit on its way is a reason to drop the fit
  if (auto step = fitter.take_step(); step && fitter.busy()) {
    // The organ may be far from where the template was.
    if (!std::exchange(editing.work.fit_seen, true)) look_at_mesh(editing.state, *step);
    session.preview(SetPoints{FoundBy::fit, std::nullopt, std::move(step)}, {}, fitter.of());
  }
  if (auto done = fitter.take()) {
    if (*done) return take_fit(editing, std::move(**done));
    session.preview(std::nullopt);
    add_notice(editing.state, done->error().sentence());
  }
}

void update_contour_fit(Editing& editing) {
  auto fitted = editing.work.contour_fits.take();
  if (!fitted) return;
  for (const std::string& warning : fitted->warnings) add_notice(editing.state, "Contours: " + warning + ".", false);
  editing.state.found.fitted_contours = std::move(fitted);
}

void update_propagation(Editing& editing) {
  Propagator& propagator = editing.work.propagator;
  if (propagator.document() && !propagator.still_of(*editing.shown.snapshot().document)) {
    propagator.cancel();
    add_notice(editing.state, "The propagation was stopped, because the case was edited meanwhile. Start it again.",
               false);
  }
  auto done = propagator.take();
  if (!done) return;
  if (!*done) return add_notice(editing.state, done->error().sentence());
  std::erase_if(**done, [&](const auto& of) {
    const Structure* structure = editing.shown.snapshot().document->structure(of.first);
    return structure == nullptr || editing.state.look.structures.locks(structure->id);
  });
  if ((**done).empty())
    return add_notice(editing.state, "Nothing was carried: what was to go through the cine is locked by now.", false);
  editing.log.is_done(PropagateFrames{});
  std::size_t in_doubt = 0, carried = 0;
  bool joined = false;
  for (auto& [structure, edit] : **done)
    for (SetPoints& action : edit.actions) {
      in_doubt += action.doubt.empty() ? 0 : 1;
      carried += action.by == FoundBy::propagation ? 1 : 0;
      editing.shown.session().apply(std::move(action), std::exchange(joined, true), structure);
    }
  const std::size_t structures = (**done).size();
  const std::string news =
      (structures > 1 ? std::to_string(structures) + " structures carried: " : "Carried through ") +
      std::to_string(carried) + (structures > 1 ? " mesh" : " frame") +
      (carried == 1     ? ""
       : structures > 1 ? "es"
                        : "s");
  add_notice(editing.state,
             in_doubt == 0 ? news + "; none is in doubt."
                           : news + "; " + std::to_string(in_doubt) + (in_doubt == 1 ? " is" : " are") +
                                 " in doubt. Look there (Cine, Next in doubt), correct the mesh and propagate again.",
             false);
}

void update_learning(Editing& editing) {
  EditorState& state = editing.state;
  StudyAppearance& appearance = editing.work.study_appearance;
  for (const std::string& sentence : appearance.update()) add_notice(state, sentence, false);
  const Snapshot& snapshot = editing.shown.snapshot();
  const Structure* structure = active_structure(state, *snapshot.document);
  auto cases = cases_to_learn(state.models.study, snapshot.file);
  if (!state.automatic.snap.learn || structure == nullptr || cases.empty())
    appearance.forget();
  else
    appearance.ask(std::move(cases), structure->the_template->topology->vertices());
  state.automatic.snap.learned = appearance.learned().appearance;
}

void blend_model(Editing& editing, const BlendModel& command) {
  if (!editing.state.models.made.model || !active_shape(editing.state, *editing.shown.snapshot().document)) return;
  ask_model(editing);
  editing.state.automatic.model_help = command.strength;
  SessionThread& session = editing.shown.session();
  auto complete = editing.work.model_help.completion(command.strength);
  if (command.strength <= 0) complete = without_help;
  if (!complete) {
    session.preview(std::nullopt);
    editing.work.blend_wanted = command;
    return;
  }
  editing.work.blend_wanted.reset();
  const std::string& of = editing.state.look.structure;
  if (!command.commit) return session.preview(std::nullopt, {std::move(complete)}, of);
  session.apply_computed(std::move(complete), false, of);
  let_shared_follow(editing.shown.document(), of, editing.out);
}

void update_model_help(Editing& editing) {
  EditorState& state = editing.state;
  Work& work = editing.work;
  if (const auto error = work.model_help.update()) {
    add_notice(state, *error);
    work.blend_wanted.reset();
    state.automatic.model_help = 0;
  }
  if (state.automatic.model_help <= 0) return;
  const auto shown = active_shape(state, *editing.shown.snapshot().document);
  if (!state.models.made.model || !shown ||
      state.models.made.model->vertices() != shown->the_template().topology->vertices()) {
    state.automatic.model_help = 0;
    return;
  }
  ask_model(editing);  // the study may have grown
  if (work.blend_wanted && !work.model_help.busy()) blend_model(editing, BlendModel(*work.blend_wanted));
}

bool show_snap(Editing& editing) {
  EditorState& state = editing.state;
  if (auto found = editing.work.snaps.take()) {
    if (!found->warning.empty()) add_notice(state, found->warning, false);
    state.found.snapped = std::move(found);
    state.look.shows_confidence = state.automatic.snap.show_confidence;
  }
  say_what_is_held(editing);
  const auto view = editing.shape();
  const bool shown = state.found.snapped && view && state.found.snapped->is_of(*view->shape.points);
  auto confidence = shown ? state.found.snapped->confidence : nullptr;
  const bool changed = confidence != state.found.confidence;
  state.found.confidence = std::move(confidence);
  if (changed) {
    const Mesh mesh = view ? view->mesh() : Mesh();
    state.found.unclear_edges =
        state.found.confidence ? unclear_edges(mesh, *state.found.confidence) : std::vector<Finding>();
  }
  return changed;
}

}  // namespace homolog
