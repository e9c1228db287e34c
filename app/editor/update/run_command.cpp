#include <utility>

#include "app/editor/update/editing.h"
#include "app/editor/update/status.h"
#include "core/base/processes/guarded.h"

namespace homolog {

Work::Work(const std::function<void()>& wake)
    : opener(wake),
      exports(wake),
      imports(wake),
      observers(wake),
      fitter(wake),
      set_fitter(wake),
      propagator(wake),
      template_maker(wake),
      label_surfaces(wake),
      study_appearance(wake),
      study_optimiser(wake),
      model_help(wake),
      models(wake),
      worklist(wake),
      quality(wake, "The mesh's figures", quality_of),
      measurements(wake, "The measurements", {}),
      scores(wake, "The score", {}),
      score_model(wake),
      recovery(wake) {}

bool Work::busy() const {
  return opener.busy() || imports.busy() || exports.busy() || template_maker.busy() || fitter.busy() ||
         set_fitter.busy() || propagator.busy() || observers.busy() || study_appearance.busy() ||
         study_optimiser.busy() || model_help.busy() || label_surfaces.busy() || models.busy() || worklist.busy() ||
         snaps.busy() || contour_fits.busy() || score_model.busy() || recovery.busy();
}

void Outbox::apply(Action action, bool joined) {
  send(ApplyEdit{std::move(action), joined});
}

void Outbox::preview(std::optional<Action> action) {
  send(PreviewEdit{std::move(action)});
}

void run(const Command& command, Editing& editing) {
  // One that fails does not take the others with it.
  const auto done = guarded("", [&]() -> Result<void> {
    if (!command.run_on_state(editing.state, editing.controls(), editing.out)) command.run(editing);
    editing.log.was_given(command);
    return {};
  });
  if (!done) add_notice(editing.state, done.error().sentence());
}

bool Editing::refuses_edits() const {
  if (!active_is_locked(state, shown.document())) return false;
  add_notice(state, locked_sentence(*structure()), false);
  return true;
}

void Editing::apply(Action action, bool joined) const {
  if (works_on_structure(action) && refuses_edits()) return;
  std::string of = works_on_structure(action) ? state.look.structure : std::string();
  shown.session().apply(std::move(action), joined, std::move(of));
}

void stop_playing(Editing& editing) {
  editing.state.look.playing = false;
  if (editing.state.look.shown_frame) {
    editing.apply(SetFrame{*editing.state.look.shown_frame});
    editing.log.is_done(ShowFrame{*editing.state.look.shown_frame});
  }
  editing.state.look.shown_frame.reset();
}

bool lacks_template(Editing& editing) {
  const Document& document = *editing.shown.snapshot().document;
  if (!document.structures.empty()) return false;
  add_notice(editing.state, why_no_mesh(editing.state, document), false);
  return true;
}

}  // namespace homolog
