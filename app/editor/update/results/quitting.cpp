#include "app/editor/update/results/quitting.h"

namespace homolog {

void quit_when_written(Editing& editing, bool without_study) {
  EditorState& state = editing.state;
  state.quitting = without_study ? Quitting::when_written_without_study : Quitting::when_written;
  if (!without_study) editing.work.models.write_if_changed(state.models);
  const auto shapes = editing.work.models.exports_running();
  if (const auto file = shapes ? shapes : editing.work.exports.running()) {
    const std::string name = std::filesystem::path(file->subject).filename().string();
    add_notice(state, "Homolog closes as soon as " + name + " is written.", false);
  }
  update_quit(editing);
}

void update_quit(Editing& editing) {
  EditorState& state = editing.state;
  Models& models = editing.work.models;
  if (state.quitting == Quitting::asked && editing.shown.at_rest()) {
    state.quitting = Quitting::no;
    // A study that could not be saved as another file: writing the study's own file again does not mend that.
    if (!models.unwritten().empty() && models.unwritten() != state.models.kept.file) {
      state.dialog = QuitDialog{models.unwritten()};
      return;
    }
    if (!has_unsaved_edits(editing.shown.snapshot())) return quit_when_written(editing, false);
    state.dialog = QuitDialog{};
  }
  if (state.quitting == Quitting::no || state.quitting == Quitting::asked || editing.work.exports.busy() ||
      models.exports_running())
    return;
  if (state.quitting == Quitting::when_written) {
    if (models.files_running()) return;
    models.take_files(state, editing.out);
    if (!models.unwritten().empty()) {
      state.quitting = Quitting::no;
      state.dialog = QuitDialog{models.unwritten()};
      return;
    }
    if (models.write_if_changed(state.models)) return;  // it was changed meanwhile
  }
  editing.shown.keep_looks(state);
  state.quitting = Quitting::now;
}

}  // namespace homolog
