#pragma once

namespace homolog {

/// ImGui without anything that draws, for as long as this lives.
class ImGuiAlone {
 public:
  ImGuiAlone();
  ~ImGuiAlone();
  ImGuiAlone(const ImGuiAlone&) = delete;
  ImGuiAlone& operator=(const ImGuiAlone&) = delete;
};

/// ImGui with its OpenGL 3 backend, for as long as this lives. Needs a current context throughout.
class ImGuiOnOpenGl {
 public:
  ImGuiOnOpenGl();
  ~ImGuiOnOpenGl();
  ImGuiOnOpenGl(const ImGuiOnOpenGl&) = delete;
  ImGuiOnOpenGl& operator=(const ImGuiOnOpenGl&) = delete;

 private:
  ImGuiAlone imgui_;
};

/// Whether a window of ImGui that takes the mouse lies at a px, as of the last frame.
bool interface_at(double x_px, double y_px);

/// Ends a frame whose drawing was broken off by an exception, so that the next can begin.
void end_broken_frame();

}  // namespace homolog
