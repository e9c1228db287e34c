#pragma once

#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "app/editor/window/editor_app.h"
#include "app/editor/window/input_queue.h"

namespace homolog {

/// A pointer in the views that keys move and press: whatever the mouse does there, the keyboard does too. `V` shows it
/// in a view at the cross-hair, and takes it to the next view.
class KeyPointer {
 public:
  struct Move {
    double x_px = 0, y_px = 0;
  };
  struct Button {
    MouseButton button = MouseButton::left;
    bool down = false;
  };
  struct Wheel {
    double steps = 0;
  };
  using Act = std::variant<Move, Button, Wheel>;

  bool shown() const { return view_.has_value(); }
  /// The acts of a mouse in place of the key; none where the key is not for the pointer.
  std::optional<std::vector<Act>> press(const KeyStroke& stroke, const EditorApp& app);
  /// The button that it holds down, which is let go with that.
  std::optional<MouseButton> let_go() { return std::exchange(down_, std::nullopt); }
  /// The mouse moved: the pointer is where that is.
  void hide() { view_.reset(); }

 private:
  std::vector<Act> to_next_view(const EditorApp& app);
  std::vector<Act> press_button(MouseButton button);
  std::vector<Act> click();
  std::optional<std::vector<Act>> move(const KeyStroke& stroke, const EditorApp& app);

  std::optional<std::size_t> view_;  ///< the index of the rectangle that it is in
  double x_px_ = 0, y_px_ = 0;
  std::optional<MouseButton> down_;
};

}  // namespace homolog
