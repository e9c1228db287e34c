#include "app/lab/bench_hand.h"

#include <imgui.h>

#include <chrono>
#include <thread>

namespace homolog {

void BenchHand::frame() {
  constexpr double frame_seconds = 1.0 / 60;
  seconds_ += frame_seconds;
  app_.update(seconds_);
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {width_px, height_px};
  io.DeltaTime = static_cast<float>(frame_seconds);
  input_.feed(io, {}, seconds_);
  if (framebuffer_ != nullptr) framebuffer_->bind();
  app_.draw(width_px, height_px, 0);
}

void BenchHand::rest() {
  do {
    frame();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while (!at_rest());
}

}  // namespace homolog
