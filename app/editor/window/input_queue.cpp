#include "app/editor/window/input_queue.h"

#include <imgui.h>

#include <algorithm>
#include <utility>

namespace homolog {

void InputQueue::press(const KeyStroke& stroke) {
  waiting_.emplace_back(stroke);
  ++keys_waiting_;
}

void InputQueue::type(unsigned int character) {
  waiting_.emplace_back(character);
  ++keys_waiting_;
}

void InputQueue::move(float x_px, float y_px) {
  // Of moves that follow each other only where they lead counts.
  if (!waiting_.empty() && std::holds_alternative<Move>(waiting_.back())) waiting_.pop_back();
  waiting_.emplace_back(Move{x_px, y_px});
}

void InputQueue::leave() {
  move(Move().x_px, Move().y_px);
}

bool InputQueue::feed_mouse(float& wheel, Fed& fed) {
  const auto& first = waiting_.front();
  if (const auto* to = std::get_if<Move>(&first)) {
    if (fed.clicked || fed.turned) return false;
    pointer_ = *to;
    fed.moved = true;
  } else if (const auto* button = std::get_if<Button>(&first)) {
    // A drag is let go a frame after its last move, which would not count otherwise.
    if (fed.clicked || (fed.moved && !button->down)) return false;
    down_[static_cast<std::size_t>(button->button)] = button->down;
    fed.clicked = true;
    if (frames_to_wait_ > 0) wait_for_field();
  } else {
    if (fed.clicked) return false;
    wheel += std::get<Wheel>(first).steps;
    fed.turned = true;
  }
  waiting_.pop_front();
  return true;
}

bool InputQueue::feed_key(ImGuiIO& io, std::optional<int> let_go, const Press& press) {
  if (const auto* character = std::get_if<unsigned int>(&waiting_.front())) {
    io.AddInputCharacter(*character);
    waiting_.pop_front();
    --keys_waiting_;
    return true;
  }
  const KeyStroke stroke = std::get<KeyStroke>(waiting_.front());
  if (stroke.key == let_go) return false;  // the same key again: ImGui has to see it up for a frame
  waiting_.pop_front();
  --keys_waiting_;
  if (press(stroke)) {
    io.KeysDown[stroke.key] = true;
    io.KeyShift = stroke.shift;
    io.KeyCtrl = stroke.ctrl;
    io.KeyAlt = stroke.alt;
    held_ = stroke.key;
    return false;
  }
  return frames_to_wait_ == 0;
}

void InputQueue::feed(ImGuiIO& io, const Press& press) {
  const std::optional<int> let_go = std::exchange(held_, std::nullopt);
  if (let_go) io.KeysDown[*let_go] = false;
  const bool hold_keys = frames_to_wait_ > 0;
  if (hold_keys) --frames_to_wait_;
  Fed fed;
  while (!waiting_.empty()) {
    const bool of_keys =
        std::holds_alternative<KeyStroke>(waiting_.front()) || std::holds_alternative<unsigned int>(waiting_.front());
    if (of_keys && (hold_keys || fed.clicked)) break;
    if (!(of_keys ? feed_key(io, let_go, press) : feed_mouse(io.MouseWheel, fed))) break;
  }
  io.MousePos = {pointer_.x_px, pointer_.y_px};
  std::copy(down_.begin(), down_.end(), io.MouseDown);
}

}  // namespace homolog
