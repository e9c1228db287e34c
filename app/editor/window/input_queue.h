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

/// What the mouse and the keyboard did, handed on to ImGui one frame at a time in the order in which it happened. ImGui
/// 1.86 looks at both once a frame: a button or a key that is pressed and let go in between is lost, a press counts
/// where the pointer has gone meanwhile, and characters overtake keys. A field takes the keyboard, and gives it back,
/// some frames after the key or the click that it follows; what was typed meanwhile waits here.
class InputQueue {
 public:
  /// What a key does; true where a text field is to have it too.
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
  /// What the frame that is being fed has had of the mouse.
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
