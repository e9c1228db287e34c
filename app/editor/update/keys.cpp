#include <algorithm>

#include "app/editor/update/controls.h"

namespace homolog {

namespace {

/// Keys of an open dialog; all keys stop there.
void press_dialog_key(EditorState& state, int key, Outbox& out) {
  auto* files = std::get_if<FileDialog>(&*state.dialog);
  if (key == key::escape) {
    state.dialog.reset();
    return;
  }
  if (files == nullptr) {
    if (key == key::f1 && std::holds_alternative<KeysDialog>(*state.dialog)) state.dialog.reset();
    return;
  }
  switch (key) {
    case key::up:
      return press_key(files->browser, BrowserKey::up);
    case key::down:
      return press_key(files->browser, BrowserKey::down);
    case key::page_up:
      return press_key(files->browser, BrowserKey::page_up);
    case key::page_down:
      return press_key(files->browser, BrowserKey::page_down);
    case key::backspace:
      if (files->browser.name.empty()) press_key(files->browser, BrowserKey::parent);
      return;
    case key::enter:
    case key::keypad_enter:
      return accept_file_dialog(state, out);
    default:
      return;
  }
}

void press_command_key(EditorState& state, const InputEvent& event, int key, const ControlsContext& context,
                       Outbox& out) {
  switch (key) {
    case 'O':
      return show_file_dialog(state, FilePurpose::open);
    case 'S':
      return out.send(SaveCase{event.shift});
    case 'Z':
      if (event.shift ? context.can_redo : context.can_undo) event.shift ? out.apply(Redo{}) : out.apply(Undo{});
      return;
    case 'Y':
      if (context.can_redo) out.apply(Redo{});
      return;
    case 'Q':
      return out.send(Quit{});
    default:
      return;
  }
}

bool press_look_key(EditorState& state, int key) {
  switch (key) {
    case 'A':
      look_from(state, LookFrom::anterior);
      return true;
    case 'P':
      look_from(state, LookFrom::posterior);
      return true;
    case 'L':
      look_from(state, LookFrom::left);
      return true;
    case 'R':
      look_from(state, LookFrom::right);
      return true;
    case 'S':
      look_from(state, LookFrom::superior);
      return true;
    case 'I':
      look_from(state, LookFrom::inferior);
      return true;
    default:
      return false;
  }
}

void choose_sigma(EditorState& state, std::size_t preset, Outbox& out) {
  state.sigma_preset = preset;
  if (!state.drag) return;
  if (auto* stroke = std::get_if<StrokeDrag>(&*state.drag)) {
    stroke->stroke.sigma_mm = state.sigma_mm();
    if (const auto action = drag_action(state)) out.preview(action);
  }
}

void scroll_by_key(EditorState& state, const ControlsContext& context, double steps) {
  const ViewKind kind = state.hover ? state.hover->view : ViewKind::axial;
  if (kind != ViewKind::space) scroll_slice(state, kind, context.document, steps);
}

std::optional<MouseTool> tool_of_key(int key) {
  switch (key) {
    case 'P':
      return MouseTool::pull;
    case 'G':
      return MouseTool::grab;
    case 'S':
      return MouseTool::slide;
    case 'R':
      return MouseTool::relax;
    case 'M':
      return MouseTool::place;
    case 'L':
      return MouseTool::landmark;
    case 'B':
      return MouseTool::stiffness;
    case 'C':
      return MouseTool::confirm;
    case 'D':
      return MouseTool::ruler;
    default:
      return std::nullopt;
  }
}

}  // namespace

void press_key(EditorState& state, const InputEvent& event, int key, const ControlsContext& context, Outbox& out) {
  if (state.dialog) return press_dialog_key(state, key, out);
  if (state.models.shown ? press_models_key(state, event, key, out) : key == key::tab) {
    if (key == key::tab) state.models.shown = !state.models.shown;
    return;
  }
  if (event.ctrl) return press_command_key(state, event, key, context, out);
  if (event.shift && press_look_key(state, key)) return;
  if (const auto tool = tool_of_key(key); tool && !state.drag) {
    state.tool = *tool;
    if (*tool == MouseTool::place || *tool == MouseTool::landmark)
      state.preferences.sections_open[place_section] = true;
    return;
  }
  switch (key) {
    case '1':
    case '2':
    case '3':
      return choose_sigma(state, static_cast<std::size_t>(key - '1'), out);
    case key::escape:
      if (state.drag)
        cancel_drag(state, out);
      else if (state.ruler)
        state.ruler.reset();
      else
        state.maximised.reset();
      return;
    case key::f1:
      state.dialog = KeysDialog{};
      return;
    case key::up:
    case key::right:
      return scroll_by_key(state, context, 1);
    case key::down:
    case key::left:
      return scroll_by_key(state, context, -1);
    case key::page_up:
      return scroll_by_key(state, context, 10);
    case key::page_down:
      return scroll_by_key(state, context, -10);
    case 'F':
      return out.send(FitViews{});
    case 'O':
      state.preferences.show.outline = !state.preferences.show.outline;
      return;
    case 'N':
      if (event.shift) {
        state.snap.with_strokes = !state.snap.with_strokes;
        add_notice(state,
                   state.snap.with_strokes ? "From now on, what you pull or grab snaps to the image (Shift+N: off)."
                                           : "Strokes no longer snap to the image.",
                   false);
        return;
      }
      return out.send(SnapMesh{state.hover && state.hover->on_mesh
                                   ? std::optional<SnapRegion>({*state.hover->on_mesh, state.sigma_mm()})
                                   : std::nullopt});
    case 'X':
      state.preferences.show.crosshair = !state.preferences.show.crosshair;
      return;
    case ' ':
      if (context.document.volume && context.document.volume->frames > 1) out.send(PlayFrames{!state.playing});
      return;
    default:
      return;
  }
}

void show_file_dialog(EditorState& state, FilePurpose purpose, std::string name) {
  const auto& preferences = state.preferences;
  FileDialog dialog;
  dialog.purpose = purpose;
  dialog.browser = browse(purpose, preferences.folder, std::move(name));
  state.dialog = std::move(dialog);
}

namespace {

void send_choice(const EditorState& state, FilePurpose purpose, const std::filesystem::path& path, Outbox& out) {
  switch (purpose) {
    case FilePurpose::open:
      return out.send(OpenFiles{{path}});
    case FilePurpose::open_template:
      return out.send(OpenTemplate{path.string()});
    case FilePurpose::open_labels:
      return out.send(OpenLabels{path});
    case FilePurpose::open_landmarks:
      return out.send(ImportLandmarks{path});
    case FilePurpose::save_case:
      return out.send(SaveCaseAs{path});
    case FilePurpose::export_mesh:
      return out.send(ExportMesh{path});
    case FilePurpose::export_label_map:
      return out.send(ExportLabelMap{path});
    case FilePurpose::export_landmarks:
      return out.send(ExportLandmarks{path});
    case FilePurpose::open_stiffness:
      return out.send(ImportStiffness{path});
    case FilePurpose::open_template_landmarks:
      return out.send(ImportTemplateLandmarks{path});
    case FilePurpose::export_template_landmarks:
      return out.send(ExportTemplateLandmarks{path});
    case FilePurpose::export_template:
      return out.send(ExportTemplate{path});
    case FilePurpose::use_made_template:
      return out.send(UseMadeTemplate{path});
    case FilePurpose::export_picture:
      return out.send(ExportPicture{path, state.picture});
    case FilePurpose::open_study:
      return out.send(OpenStudy{path});
    case FilePurpose::add_shapes:
      return out.send(AddCases{{path}});
    case FilePurpose::new_study:
      return out.send(NewStudy{path});
    case FilePurpose::save_study:
      return out.send(SaveStudyAs{path});
    case FilePurpose::export_model:
      return out.send(ExportModel{path});
    case FilePurpose::export_measures:
      return out.send(ExportEvaluation{path});
    case FilePurpose::export_plots:
      return out.send(ExportPlots{path});
    case FilePurpose::open_study_template:
      return out.change([path](EditorState& s) { set_study_template(s.models, path); });
    case FilePurpose::export_shapes:
      return out.send(ExportShapes{path, state.models.export_extension});
  }
}

}  // namespace

void accept_file_dialog(EditorState& state, Outbox& out) {
  auto& dialog = std::get<FileDialog>(*state.dialog);
  const auto path = accept(dialog.browser);
  if (!path) return;
  state.preferences.folder = path->parent_path();
  std::error_code ignored;
  if (saves(dialog.purpose) && std::filesystem::exists(*path, ignored)) {
    ReplaceDialog replace{std::move(dialog), *path};
    state.dialog = std::move(replace);
    return;
  }
  send_choice(state, dialog.purpose, *path, out);
  state.dialog.reset();
}

void accept_replacement(EditorState& state, Outbox& out) {
  const auto& dialog = std::get<ReplaceDialog>(*state.dialog);
  send_choice(state, dialog.files.purpose, dialog.path, out);
  state.dialog.reset();
}

}  // namespace homolog
