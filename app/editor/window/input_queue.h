#pragma once

#include <array>
#include <cfloat>
#include <deque>
#include <functional>
#include <optional>
#include <variant>

#include "app/editor/state/drag.h"

struct ImGuiIO;

namespace homolog {

/// A key as the window system reports it: pressed, or repeated while held.
struct KeyStroke {
  int key = 0;
  bool shift = false, ctrl = false, alt = false;
};

/// Hands the events of mouse and keyboard on to ImGui, one frame at a time and in their order. ImGui 1.86 looks at both
/// once a frame. Without the queue, a button or key that is pressed and released between two frames is lost, a press
/// counts at the place where the pointer is later, and characters overtake keys. A field takes or releases the keyboard
/// some frames after the key or click for it; what is typed meanwhile waits here.
class InputQueue {
 public:
  /// The action of a key; true where a text field is to have it too.
  using Press = std::function<bool(const KeyStroke&)>;

  void press(const KeyStroke& stroke);
  void type(unsigned int character);
  void move(float x_px, float y_px);
  /// The pointer has left the window.
  void leave();
  void button(MouseButton button, bool down) { waiting_.emplace_back(Button{button, down}); }
  void wheel(float steps) { waiting_.emplace_back(Wheel{steps}); }
  /// A field opens or closes: the next frames are for that alone.
  void wait_for_field() { frames_to_wait_ = frames_of_field; }
  /// Whether further frames are needed to hand everything on.
  bool busy() const { return !waiting_.empty() || keys_wait(); }
  /// Whether a key that is pressed now has to wait for others.
  bool keys_wait() const { return keys_waiting_ > 0 || frames_to_wait_ > 0 || held_; }

  /// Before each ImGui frame: passes on what one frame can take.
  void feed(ImGuiIO& io, const Press& press);

 private:
  static constexpr int frames_of_field = 3;
  struct Move {
    float x_px = -FLT_MAX, y_px = -FLT_MAX;  ///< outside of the window
  };
  struct Button {
    MouseButton button = MouseButton::left;
    bool down = false;
  };
  struct Wheel {
    float steps = 0;
  };
  /// The mouse's events that the frame being fed has had.
  struct Fed {
    bool moved = false, clicked = false, turned = false;
  };
  /// False where the frame cannot take the first of what waits.
  bool feed_mouse(float& wheel, Fed& fed);
  bool feed_key(ImGuiIO& io, std::optional<int> let_go, const Press& press);

  Move pointer_;  ///< in ImGui's eyes, as are the buttons and the key
  std::array<bool, 3> down_{};
  std::deque<std::variant<KeyStroke, unsigned int, Move, Button, Wheel>> waiting_;
  int keys_waiting_ = 0;  ///< with the characters
  std::optional<int> held_;
  int frames_to_wait_ = 0;  ///< before the next key
};

}  // namespace homolog
