#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <variant>

struct ImGuiIO;

namespace homolog {

/// A key as the window system reports it: pressed, or repeated while held.
struct KeyStroke {
  int key = 0;
  bool shift = false, ctrl = false, alt = false;
};

/// Keys and characters in the order they were typed, handed on one frame at a time. ImGui 1.86 looks at the keyboard
/// once a frame: a key pressed and let go in between is lost, and characters overtake keys. A field takes
/// the keyboard, and gives it back, some frames after the key or the click that it follows; what was typed meanwhile
/// waits here.
class KeyQueue {
 public:
  /// What a key does; true where a text field is to have it too.
  using Press = std::function<bool(const KeyStroke&)>;

  void press(const KeyStroke& stroke) { typed_.emplace_back(stroke); }
  void type(unsigned int character) { typed_.emplace_back(character); }
  /// A field opens or closes: the next frames are for that alone.
  void wait_for_field() { frames_to_wait_ = 3; }
  bool busy() const { return !typed_.empty() || frames_to_wait_ > 0 || held_; }

  /// Before each ImGui frame: passes on characters up to the next key, and that key.
  void feed(ImGuiIO& io, const Press& press);

 private:
  std::deque<std::variant<KeyStroke, unsigned int>> typed_;
  std::optional<int> held_;  ///< down in ImGui's eyes
  int frames_to_wait_ = 0;
};

}  // namespace homolog
