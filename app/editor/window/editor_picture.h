#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "app/editor/update/commands.h"
#include "app/editor/widgets/drawn_items.h"
#include "core/base/pictures/picture.h"
#include "core/session/session.h"

namespace homolog {

/// The editor's window as it would look, without a display. Needs an OpenGL context that is current (see
/// OffscreenContext). `arrange` may change what the editor shows (views, tool, open sections) after the case is opened;
/// preferences are the defaults. `preview` is an edit that is shown as if it were being dragged.
struct EditorPictureOptions {
  int width_px = 1280, height_px = 800;
  float scale = 1;
  std::function<void(EditorState&)> arrange;
  std::optional<Action> preview;
  std::optional<Command> models;            ///< done when the study's model is made
  std::optional<PictureOptions> part;       ///< a view, or shapes of the study, in place of the window
  std::vector<DrawnItem>* items = nullptr;  ///< gets the controls and texts of the picture
};
Result<Picture> editor_picture(EditSession session, const EditorPictureOptions& options);

}  // namespace homolog
