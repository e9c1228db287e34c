#pragma once

namespace homolog {

/// ImGui with its OpenGL 3 backend, for as long as this lives. Needs a current context throughout.
class ImGuiOnOpenGl {
 public:
  ImGuiOnOpenGl();
  ~ImGuiOnOpenGl();
  ImGuiOnOpenGl(const ImGuiOnOpenGl&) = delete;
  ImGuiOnOpenGl& operator=(const ImGuiOnOpenGl&) = delete;
};

/// Whether a window of ImGui that takes the mouse lies at a px, as of the last frame.
bool interface_at(double x_px, double y_px);

}  // namespace homolog
