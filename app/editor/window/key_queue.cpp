#include "app/editor/window/key_queue.h"

#include <imgui.h>

#include <utility>

namespace homolog {

void KeyQueue::feed(ImGuiIO& io, const Press& press) {
  const std::optional<int> let_go = std::exchange(held_, std::nullopt);
  if (let_go) io.KeysDown[*let_go] = false;
  if (frames_to_wait_ > 0) {
    --frames_to_wait_;
    return;
  }
  while (!typed_.empty()) {
    if (const auto* character = std::get_if<unsigned int>(&typed_.front())) {
      io.AddInputCharacter(*character);
      typed_.pop_front();
      continue;
    }
    const KeyStroke stroke = std::get<KeyStroke>(typed_.front());
    if (stroke.key == let_go) return;  // the same key again: ImGui has to see it up for a frame
    typed_.pop_front();
    if (press(stroke)) {
      io.KeysDown[stroke.key] = true;
      io.KeyShift = stroke.shift;
      io.KeyCtrl = stroke.ctrl;
      io.KeyAlt = stroke.alt;
      held_ = stroke.key;
      return;
    }
    if (frames_to_wait_ > 0) return;
  }
}

}  // namespace homolog
