#pragma once

#include <filesystem>
#include <string>

#include "app/editor/state/state.h"
#include "app/editor/update/commands/logged.h"
#include "app/editor/update/commands/looks/setting.h"
#include "app/editor/work/files/file_browsing.h"

namespace homolog {

class Fields;
class Outbox;
struct ControlsContext;
struct Editing;

// Dialogs and notices.

/// Asks for a file; `name` is the one that is offered for a new one.
struct ShowFileDialog {
  static constexpr const char* key = "show file dialog";
  static constexpr Logged logged = Logged::never;
  FilePurpose purpose = FilePurpose::open;
  std::string name;
  void spell(Fields& line);
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
struct DismissNotice {
  static constexpr const char* key = "dismiss notice";
  std::size_t index = 0;
  void spell(Fields& line);
  void run(EditorState& state) const;
};

// In the file dialog.

using EnterFolder = DialogCall<"enter folder", "folder", enter_folder, &FileDialog::browser>;
/// Goes along the list by the keyboard, or to the folder above.
struct MoveInFiles {
  static constexpr const char* key = "move in files";
  static constexpr Logged logged = Logged::never;
  BrowserKey by = BrowserKey::down;
  bool extends = false;  ///< files on the way are chosen too, where the dialog takes several
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct SelectFile {
  static constexpr const char* key = "select file";
  static constexpr Logged logged = Logged::never;
  int index = 0;  ///< its number among those that the dialog lists
  Choosing how = Choosing::alone;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Filters the list, or names the new file.
using TypeFileName = DialogCall<"type file name", "name", type_name, &FileDialog::browser>;
/// Also files of other kinds, and hidden ones.
struct ShowAllFiles {
  static constexpr const char* key = "show all files";
  static constexpr Logged logged = Logged::never;
  bool all = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Makes it, and goes there.
using MakeFolder = PlainDialogCall<"make folder", make_typed_folder, &FileDialog::browser>;
/// Does what the chosen file is for.
struct AcceptFile {
  static constexpr const char* key = "accept file";
  static constexpr Logged logged = Logged::never;
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
/// Writes over the file that is there.
struct AcceptReplacement {
  static constexpr const char* key = "accept replacement";
  static constexpr Logged logged = Logged::never;
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
/// Goes back from the question whether a file is to be replaced.
struct ChooseOtherName {
  static constexpr const char* key = "choose other name";
  static constexpr Logged logged = Logged::never;
  void run(EditorState& state) const;
};

// In the others.

/// Lists the cases that were never saved.
struct ShowRecovery {
  static constexpr const char* key = "show recovery";
  static constexpr Logged logged = Logged::never;
  void run(Editing& editing) const;
};
struct DiscardCase {
  static constexpr const char* key = "discard case";
  std::filesystem::path journal;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct Quit {
  static constexpr const char* key = "quit";
  static constexpr Logged logged = Logged::never;
  bool sure = false;           ///< an unsaved case is not asked about again
  bool without_study = false;  ///< nor a study that could not be written
  void spell(Fields& line);
  void run(Editing& editing) const;
};

}  // namespace homolog
