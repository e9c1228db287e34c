#include "app/editor/update/commands/dialog_commands.h"

#include <algorithm>
#include <system_error>

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/controls.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/file_purposes.h"
#include "app/editor/update/results/quitting.h"
#include "app/editor/work/opening/recovery.h"

namespace homolog {

namespace {

/// Whether the file dialog that is open takes several files.
bool takes_several(EditorState& state) {
  const auto* files = open_dialog<FileDialog>(state);
  return files != nullptr && file_purpose(files->purpose).command_of_several != nullptr;
}

FileBrowser* open_browser(EditorState& state) {
  auto* files = open_dialog<FileDialog>(state);
  return files != nullptr ? &files->browser : nullptr;
}

/// Where something of what is open was saved last, for what is written. Else the folder of what is open: in Models of
/// the study, else of the image or, for what is written, of the case. Where nothing has a file, the one used last.
std::filesystem::path folder_beside(const EditorState& state, const ControlsContext& context, bool saves) {
  if (saves && is_for_people(state.saving.saved_folder)) return state.saving.saved_folder;
  const std::filesystem::path of_case = context.file, of_image = context.document.scan.source;
  const auto first = state.models.shown ? state.models.kept.file : saves ? of_case : of_image;
  const auto second = state.models.shown ? state.models.kept.file : saves ? of_image : of_case;
  for (const auto& folder : {first.parent_path(), second.parent_path(), state.preferences.folder})
    if (is_for_people(folder)) return folder;
  return {};
}

}  // namespace

void ShowFileDialog::spell(Fields& line) {
  std::string purpose_name = file_purpose(purpose).name;
  line.member("purpose", purpose_name);
  if (line.reads()) {
    const auto known = purpose_of(purpose_name);
    if (!known) throw Unreadable{"\"" + excerpt(purpose_name) + "\" is no purpose of a file dialog"};
    purpose = *known;
  }
  line.member("name", name);
}
void ShowFileDialog::run(EditorState& state, const ControlsContext& context, Outbox&) const {
  FileDialog dialog;
  dialog.purpose = purpose;
  const FileKind& files = file_purpose(purpose).files;
  dialog.browser = browse(files, folder_beside(state, context, files.saves), name);
  state.dialog = std::move(dialog);
}

void DismissNotice::spell(Fields& line) {
  line.member("index", index);
}
void DismissNotice::run(EditorState& state) const {
  if (index < state.notices.size()) state.notices.erase(state.notices.begin() + static_cast<std::ptrdiff_t>(index));
}

void MoveInFiles::spell(Fields& line) {
  static constexpr std::array names{"up", "down", "page up", "page down", "parent"};
  spell_choice(line, "by", names, by);
  line.optional("extends", extends, extends);
}
void MoveInFiles::run(EditorState& state) const {
  if (auto* browser = open_browser(state)) press_key(*browser, by, extends && takes_several(state));
}

void SelectFile::spell(Fields& line) {
  static constexpr std::array names{"alone", "also", "up to"};
  line.member("index", index);
  spell_choice(line, "how", names, how);
}
void SelectFile::run(EditorState& state) const {
  if (auto* browser = open_browser(state)) {
    select_entry(*browser, index, takes_several(state) ? how : Choosing::alone);
    browser->scroll_to_selected = false;
  }
}

void ShowAllFiles::spell(Fields& line) {
  line.member("all", all);
}
void ShowAllFiles::run(EditorState& state) const {
  if (auto* browser = open_browser(state)) {
    browser->show_all = all;
    refresh(*browser);
  }
}

void AcceptFile::run(EditorState& state, const ControlsContext& context, Outbox& out) const {
  auto* dialog = open_dialog<FileDialog>(state);
  if (dialog == nullptr) return;
  if (const auto several = chosen_files(dialog->browser); several.size() > 1) {
    state.preferences.folder = several.front().parent_path();
    out.send(file_purpose(dialog->purpose).command_of_several(several));
    state.dialog.reset();
    return;
  }
  const auto path = accept(dialog->browser);
  if (!path) return;
  state.preferences.folder = path->parent_path();
  if (dialog->browser.kind.saves) state.saving.saved_folder = path->parent_path();
  std::error_code ignored;
  if (dialog->browser.kind.saves)
    for (const std::filesystem::path& file : files_written(dialog->purpose, *path, state, context.document))
      if (std::filesystem::exists(file, ignored)) {
        if (dialog->purpose == FilePurpose::make_study_template) {
          add_notice(state, file.filename().string() +
                                " exists already, and cases may have begun with it. Choose another name.");
          return;
        }
        ReplaceDialog replace{std::move(*dialog), *path, file};
        state.dialog = std::move(replace);
        return;
      }
  out.send(file_purpose(dialog->purpose).command(*path, state));
  state.dialog.reset();
}

void AcceptReplacement::run(EditorState& state, const ControlsContext&, Outbox& out) const {
  const auto* dialog = open_dialog<ReplaceDialog>(state);
  if (dialog == nullptr) return;
  out.send(file_purpose(dialog->files.purpose).command(dialog->path, state));
  state.dialog.reset();
}

void ChooseOtherName::run(EditorState& state) const {
  if (auto* replace = open_dialog<ReplaceDialog>(state)) {
    FileDialog files = std::move(replace->files);
    state.dialog = std::move(files);
  }
}

void ShowRecovery::run(Editing& editing) const {
  editing.work.recovery_offer = RecoveryOffer::asked;
  editing.work.recovery.look();
}

void DiscardCase::spell(Fields& line) {
  line.member("journal", journal);
}
void DiscardCase::run(EditorState& state) const {
  if (!discard_journal(journal)) add_notice(state, "That case is open in another window, so it was not deleted.");
  auto* recover = open_dialog<RecoverDialog>(state);
  if (recover == nullptr) return;
  std::erase_if(recover->found, [&](const auto& found) { return found.journal == journal; });
  if (recover->found.empty()) state.dialog.reset();
}

void Quit::spell(Fields& line) {
  line.member("sure", sure);
  line.member("without_study", without_study);
}
void Quit::run(Editing& editing) const {
  if (sure) return quit_when_written(editing, without_study);
  editing.shown.session().save(false);  // the case's file may be gone
  editing.state.quitting = Quitting::asked;
}

}  // namespace homolog
