#include "app/editor/update/keys.h"

#include <algorithm>

#include "app/editor/state/views.h"
#include "app/editor/update/tools/tool.h"

namespace homolog {

namespace {

using Given = std::optional<Command>;

/// Keys of an open dialog; all keys stop there.
Given dialog_command(const Dialog& dialog, int code, bool shift) {
  const auto* files = std::get_if<FileDialog>(&dialog);
  const bool names_folder = files != nullptr && files->browser.new_folder;
  if (code == key::escape) return names_folder ? Given(NameFolder{}) : CloseDialog{};
  if (files == nullptr) {
    if (code == key::f1 && std::holds_alternative<KeysDialog>(dialog)) return CloseDialog{};
    return std::nullopt;
  }
  switch (code) {
    case key::up:
      return MoveInFiles{BrowserKey::up, shift};
    case key::down:
      return MoveInFiles{BrowserKey::down, shift};
    case key::page_up:
      return MoveInFiles{BrowserKey::page_up, shift};
    case key::page_down:
      return MoveInFiles{BrowserKey::page_down, shift};
    case key::backspace:
      return files->browser.name.empty() && !names_folder ? Given(MoveInFiles{BrowserKey::parent}) : std::nullopt;
    case key::enter:
    case key::keypad_enter:
      return AcceptFile{};
    default:
      return std::nullopt;
  }
}

Given take_tool(const KeyMoment& now) {
  for (const ToolKind* kind : tool_kinds)
    if (!now.state.pointer.drag && kind->key[0] == now.code) return ChooseTool{kind->tool};
  return std::nullopt;
}

/// The keys that take a tool in hand.
std::vector<KeyRow> rows_of_tools() {
  std::vector<KeyRow> rows;
  for (const ToolKind* kind : tool_kinds)
    if (kind->key[0] != '\0') rows.push_back({kind->key, kind->in_keys, {{kind->key[0]}}, take_tool});
  return rows;
}

template <bool ShownParts::*part>
Given toggle_part(const KeyMoment& now) {
  ShownParts parts = now.state.preferences.show;
  parts.*part = !(parts.*part);
  return ShowParts{parts};
}

LookFrom side_of(int code) {
  return static_cast<LookFrom>(std::find(side_letters.begin(), side_letters.end(), code) - side_letters.begin());
}

std::vector<KeyChord> side_chords() {
  std::vector<KeyChord> chords;
  for (const char letter : side_letters) chords.push_back({letter, false, true});
  return chords;
}

Given scroll(const KeyMoment& now) {
  const ViewKind view = now.state.pointer.hover ? now.state.pointer.hover->view : ViewKind::axial;
  const double steps = now.code == key::page_up || now.code == key::page_down ? 10 : 1;
  const bool on = now.code == key::up || now.code == key::right || now.code == key::page_up;
  return ScrollSlices{view, on ? steps : -steps};
}

Given turn_page(const KeyMoment& now) {
  const std::size_t page = now.state.models.gallery.page;
  if (now.code == key::page_down) return ShowGalleryPage{page + 1};
  return page > 0 ? Given(ShowGalleryPage{page - 1}) : std::nullopt;
}

Given snap_here(const KeyMoment& now) {
  const auto& hover = now.state.pointer.hover;
  SnapMesh snap;
  if (hover && hover->on_mesh) snap.region = SnapArea{*hover->on_mesh, now.state.hand.sigma_mm()};
  return snap;
}

/// Of the keys that operate controls, and the pointer in the views: the window gives them on (input_router.cpp).
Given by_window(const KeyMoment&) {
  return std::nullopt;
}

std::vector<KeyRow> rows_without_mouse() {
  return {{"F6, Shift+F6", "keys go to bars and panels", {{key::f6}}, by_window},
          {"Tab, Enter", "there: next control; press it", {}, by_window},
          {"Ctrl+arrows", "there: changes a number", {}, by_window},
          {"V", "a pointer in the next view", {{'V'}}, by_window},
          {"Arrows, Space", "there: moves, presses", {}, by_window}};
}

std::vector<KeyRow> rows_of_case() {
  return {
      {"1 2 3",
       "\xcf\x83 small, medium, large",
       {{'1'}, {'2'}, {'3'}},
       [](const KeyMoment& now) -> Given { return ChooseSigma{static_cast<std::size_t>(now.code - '1')}; }},
      {"J", "the next place to look at", {{'J'}}, [](const KeyMoment&) -> Given { return ShowFinding{}; }},
      {"Shift+J",
       "the previous place to look at",
       {{'J', false, true}},
       [](const KeyMoment&) -> Given {
         return ShowFinding{std::nullopt, true};
       }},
      {"E, W",
       "structures: next, previous",
       {{'E'}, {'W'}},
       [](const KeyMoment& now) -> Given {
         return NextStructure{now.code == 'W', false};
       },
       false},
      {"K",
       "next doubtful structure",
       {{'K'}},
       [](const KeyMoment&) -> Given {
         return NextStructure{false, true};
       },
       false},
      {"H",
       "shapes before a repair",
       {{'H'}},
       [](const KeyMoment& now) -> Given { return ShowAsRead{!now.state.look.structures.as_read_shown}; }},
      {"N", "snap here", {{'N'}}, snap_here, false},
      {"Shift+N",
       "snap while dragging",
       {{'N', false, true}},
       [](const KeyMoment& now) -> Given { return SnapWithStrokes{!now.state.automatic.snap.with_strokes}; }},
      {"Arrows, PgUp, PgDn",
       "slices, by 1 or 10",
       {{key::up}, {key::right}, {key::down}, {key::left}, {key::page_up}, {key::page_down}},
       scroll},
      {"Space",
       "plays a cine",
       {{' '}},
       [](const KeyMoment& now) -> Given {
         const auto& volume = now.context.document.scan.image;
         return volume && volume->frames > 1 ? Given(PlayFrames{!now.state.look.playing}) : std::nullopt;
       },
       false},
      {"F", "everything in view", {{'F'}}, [](const KeyMoment&) -> Given { return ShowAll{}; }},
      {"O", "outlines", {{'O'}}, toggle_part<&ShownParts::outline>},
      {"X", "cross-hair", {{'X'}}, toggle_part<&ShownParts::crosshair>},
      {"T",
       "slices in 3D: the next look",
       {{'T'}},
       [](const KeyMoment& now) -> Given { return ShowParts{with_next_planes(now.state.preferences.show)}; }},
      {"U", "the label's surface in 3D", {{'U'}}, toggle_part<&ShownParts::label_surface>},
      {"Shift+A P L R S I", "look from that side", side_chords(),
       [](const KeyMoment& now) -> Given { return LookFromSide{side_of(now.code)}; }},
      {"Enter",
       "done, next of the study",
       {{key::enter}, {key::keypad_enter}},
       [](const KeyMoment&) -> Given { return OpenNextCase{}; },
       false},
      // Ctrl is down while a contour is drawn.
      {"Escape",
       "cancels a drag, stops a fit",
       {{key::escape}, {key::escape, true}},
       [](const KeyMoment&) -> Given { return Escape{}; }},
      {"Ctrl+Z",
       "undo, or stops a fit",
       {{'Z', true}},
       [](const KeyMoment& now) -> Given {
         if (now.context.fits) return CancelFits{};
         return now.context.can_undo ? Given(ApplyEdit{Undo{}}) : std::nullopt;
       },
       false},
      {"Ctrl+Shift+Z, Ctrl+Y",
       "redo",
       {{'Z', true, true}, {'Y', true}},
       [](const KeyMoment& now) -> Given { return now.context.can_redo ? Given(ApplyEdit{Redo{}}) : std::nullopt; },
       false},
      {"Ctrl+O",
       "open",
       {{'O', true}},
       [](const KeyMoment&) -> Given {
         return ShowFileDialog{FilePurpose::open, {}};
       },
       false},
      {"Ctrl+S", "save", {{'S', true}}, [](const KeyMoment&) -> Given { return SaveCase{}; }},
      {"Ctrl+Shift+S", "save as", {{'S', true, true}}, [](const KeyMoment&) -> Given { return SaveCase{true}; }},
      {"Ctrl+Q", "quit", {{'Q', true}}, [](const KeyMoment&) -> Given { return Quit{}; }},
      {"Tab", "the models of a study", {{key::tab}}, [](const KeyMoment&) -> Given { return ShowModels{true}; }, false},
      {"F1", "this list", {{key::f1}}, [](const KeyMoment&) -> Given { return ShowKeys{}; }},
  };
}

std::vector<KeyRow> rows_of_models() {
  return {
      {"N", "the next case that is not done", {{'N'}}, [](const KeyMoment&) -> Given { return SelectNextCase{}; }},
      {"Enter",
       "opens the selected case",
       {{key::enter}, {key::keypad_enter}},
       [](const KeyMoment& now) -> Given {
         const ModelsState& models = now.state.models;
         const StudyCase* one = find_case(models.study, models.list.selected);
         return one != nullptr ? Given(OpenCaseOfStudy{one->name, models.gallery.pinned}) : std::nullopt;
       }},
      {"PgUp, PgDn", "pages of the gallery", {{key::page_up}, {key::page_down}}, turn_page},
      {"F", "all shapes in view", {{'F'}}, [](const KeyMoment&) -> Given { return ShowAllShapes{}; }},
      {"Shift+A P L R S I", "look from that side", side_chords(),
       [](const KeyMoment& now) -> Given { return LookFromSideInGallery{side_of(now.code)}; }},
      {"Escape",
       "stops, or unmarks a vertex",
       {{key::escape}},
       [](const KeyMoment& now) -> Given {
         return now.state.models.made.optimisation.runs() ? Given(CancelOptimisation{}) : Given(PinVertex{});
       }},
      {"Ctrl+O",
       "open a study",
       {{'O', true}},
       [](const KeyMoment&) -> Given {
         return ShowFileDialog{FilePurpose::open_study, {}};
       }},
      {"Ctrl+S",
       "save the study as",
       {{'S', true}},
       [](const KeyMoment& now) -> Given {
         return ShowFileDialog{FilePurpose::save_study, now.state.models.kept.file.filename().string()};
       }},
      {"Ctrl+Q", "quit", {{'Q', true}}, [](const KeyMoment&) -> Given { return Quit{}; }},
      {"Tab", "the case", {{key::tab}}, [](const KeyMoment&) -> Given { return ShowModels{false}; }},
      {"F1", "this list", {{key::f1}}, [](const KeyMoment&) -> Given { return ShowKeys{}; }},
  };
}

/// The row of a key; where no row asks for Shift, Shift does not matter.
const KeyRow* row_of(const std::vector<KeyRow>& rows, const KeyChord& pressed) {
  const auto find = [&](bool shift) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const KeyRow& row) {
      return std::any_of(row.chords.begin(), row.chords.end(), [&](const KeyChord& chord) {
        return chord.code == pressed.code && chord.ctrl == pressed.ctrl && chord.shift == shift;
      });
    });
    return found == rows.end() ? nullptr : &*found;
  };
  const KeyRow* exact = find(pressed.shift);
  return exact != nullptr ? exact : find(false);
}

}  // namespace

const std::vector<KeyRow>& key_rows(bool in_models) {
  const auto with = [](std::vector<KeyRow> rows, const std::vector<KeyRow>& further) {
    rows.insert(rows.end(), further.begin(), further.end());
    return rows;
  };
  static const std::vector<KeyRow> of_case = with(with(rows_of_tools(), rows_of_case()), rows_without_mouse()),
                                   of_models = with(rows_of_models(), rows_without_mouse());
  return in_models ? of_models : of_case;
}

void press_key(const EditorState& state, const InputEvent& event, int key, const ControlsContext& context,
               Outbox& out) {
  Given command;
  const bool dismisses = key == key::escape && !state.pointer.drag && !state.notices.empty();
  if (state.dialog)
    command = dialog_command(*state.dialog, key, event.shift);
  else if (dismisses)
    command = DismissNotice{state.notices.size() - 1};
  else if (const KeyRow* row = row_of(key_rows(state.models.shown), {key, event.ctrl, event.shift});
           row != nullptr && (row->in_drag || !state.pointer.drag))
    command = row->command({state, context, key});
  if (command) out.send(std::move(*command));
}

}  // namespace homolog
