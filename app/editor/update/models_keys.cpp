#include "app/editor/update/controls.h"

namespace homolog {

namespace {

std::optional<LookFrom> side_of_key(int key) {
  switch (key) {
    case 'A':
      return LookFrom::anterior;
    case 'P':
      return LookFrom::posterior;
    case 'L':
      return LookFrom::left;
    case 'R':
      return LookFrom::right;
    case 'S':
      return LookFrom::superior;
    case 'I':
      return LookFrom::inferior;
    default:
      return std::nullopt;
  }
}

}  // namespace

bool press_models_key(EditorState& state, const InputEvent& event, int key, Outbox& out) {
  ModelsState& models = state.models;
  if (event.ctrl) {
    if (key == 'O') show_file_dialog(state, FilePurpose::open_study);
    if (key == 'S') show_file_dialog(state, FilePurpose::save_study, models.study_file.filename().string());
    return key != 'Q';
  }
  if (event.shift) {
    if (const auto side = side_of_key(key)) {
      const Camera3D camera = camera_from(*side, Box());
      models.camera.to_eye = camera.to_eye;
      models.camera.up = camera.up;
    }
    return true;
  }
  switch (key) {
    case key::f1:
      return false;
    case key::escape:
      unpin(models);
      break;
    case 'F':
      fit_gallery(models);
      break;
    case 'N':
      select_next_case(models);
      break;
    case key::enter:
    case key::keypad_enter:
      if (const StudyCase* one = find_case(models.study, models.selected))
        out.send(OpenCaseOfStudy{one->name, models.pinned});
      break;
    default:
      break;
  }
  return true;
}

}  // namespace homolog
