#include <utility>
#include <variant>

#include "app/editor/update/editing.h"
#include "core/base/guarded.h"

namespace homolog {

Work::Work(const std::function<void()>& wake)
    : opener(wake),
      exports(wake),
      imports(wake),
      observers(wake),
      fitter(wake),
      propagator(wake),
      template_maker(wake),
      study_appearance(wake),
      study_optimiser(wake),
      model_help(wake),
      models(wake),
      worklist(wake),
      quality(wake),
      recovery(wake) {}

bool Work::busy() const {
  return opener.busy() || imports.busy() || exports.busy() || template_maker.busy() || fitter.busy() ||
         propagator.busy() || observers.busy() || study_appearance.busy() || study_optimiser.busy() ||
         model_help.busy() || models.busy() || worklist.busy() || snaps.busy();
}

bool run_on_state(const Command& command, EditorState& state, const ControlsContext& context, Outbox& out) {
  const auto run_one = [&](const auto& one) {
    constexpr bool by_editor = requires(Editing & editing) {
      one.run(editing);
    };
    static_assert(
        by_editor || requires { one.run(state); } || requires { one.run(state, context, out); },
        "run() takes an Editing, an EditorState, or a state with its controls and outbox");
    if constexpr (requires { one.run(state); }) {
      one.run(state);
      return true;
    } else if constexpr (requires { one.run(state, context, out); }) {
      one.run(state, context, out);
      return true;
    }
    return false;
  };
  return std::visit(run_one, command);
}

void run(const Command& command, Editing& editing) {
  // One that fails does not take the others with it.
  const auto done = guarded("", [&]() -> Result<void> {
    const auto run_one = [&](const auto& one) {
      if constexpr (requires { one.run(editing); }) one.run(editing);
    };
    if (!run_on_state(command, editing.state, editing.controls(), editing.out)) std::visit(run_one, command);
    editing.log.was_given(command);
    return {};
  });
  if (!done) add_notice(editing.state, done.error().sentence());
}

void stop_playing(Editing& editing) {
  editing.state.playing = false;
  if (editing.state.shown_frame) {
    editing.shown.session().apply(SetFrame{*editing.state.shown_frame});
    editing.log.is_done(ShowFrame{*editing.state.shown_frame});
  }
  editing.state.shown_frame.reset();
}

}  // namespace homolog
