#pragma once

#include <Eigen/Core>

#include "app/editor/window/input_router.h"
#include "render/offscreen.h"

namespace homolog {

/// The editor in a window of 1280×800 without a display, with a hand on mouse and keys: frames as a person sees them,
/// to be timed.
class BenchHand {
 public:
  static constexpr int width_px = 1280, height_px = 800;

  /// `framebuffer` is null where nothing is drawn.
  BenchHand(EditorApp& app, Framebuffer* framebuffer) : app_(app), input_(app), framebuffer_(framebuffer) {}

  void frame();
  /// Goes on until all that was asked for is done.
  void rest();
  bool at_rest() const { return app_.at_rest() && !input_.busy(); }
  void move(const Eigen::Vector2d& to) { input_.move(to.x(), to.y(), {}, seconds_); }
  void button(bool down) { input_.button(MouseButton::left, down, {}, seconds_); }
  void key(int code) { input_.press({code}, seconds_); }

 private:
  EditorApp& app_;
  InputRouter input_;
  Framebuffer* framebuffer_;
  double seconds_ = 0;
};

}  // namespace homolog
