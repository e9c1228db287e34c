#pragma once

#include "app/editor/window/editor_app.h"
#include "app/editor/window/input_queue.h"
#include "app/editor/window/key_pointer.h"

namespace homolog {

/// The way of an event from the window system to whom it is for: the views, the keys' commands, ImGui's controls and
/// fields. The window's callbacks end here, and so do the tests' hands. Places are px of the framebuffer.
class InputRouter {
 public:
  /// Keys held while something else happens.
  struct Held {
    bool shift = false, ctrl = false, alt = false;
  };

  explicit InputRouter(EditorApp& app) : app_(app) {}

  // `seconds` is a clock, for double clicks.
  void move(double x_px, double y_px, const Held& held, double seconds);
  /// The pointer has left the window.
  void leave() { queue_.leave(); }
  void button(MouseButton button, bool down, const Held& held, double seconds);
  void wheel(double steps, const Held& held, double seconds);
  /// A key that is pressed, or repeated while it is held.
  void press(const KeyStroke& stroke, double seconds);
  void let_go(const Held& held, double seconds);
  void type(unsigned int character);

  /// Whether further frames are needed to take in what happened.
  bool busy() const { return queue_.busy(); }
  /// Before each ImGui frame: what it gets of all that. `held` and `seconds` are those of now.
  void feed(ImGuiIO& io, const Held& held, double seconds);

 private:
  void send(decltype(InputEvent::what) what, const Held& held, double seconds);
  void move_to(double x_px, double y_px, const Held& held, double seconds);
  void press_button(MouseButton button, bool down, const Held& held, double seconds);
  /// Does what a key is for; true where a text field is to have it too.
  bool do_key(const KeyStroke& stroke, double seconds);
  /// Whether a key was for the controls that it can reach.
  bool give_to_controls(const KeyStroke& stroke, bool in_field);
  /// Whether it was for the pointer that keys move.
  bool give_to_pointer(const KeyStroke& stroke, double seconds);

  EditorApp& app_;
  InputQueue queue_;
  KeyPointer key_pointer_;
  double x_px_ = 0, y_px_ = 0;  ///< the place of the latest event; the pointer may be elsewhere by now
};

}  // namespace homolog
