#include "app/editor/widgets/imgui_context.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>

namespace homolog {

ImGuiOnOpenGl::ImGuiOnOpenGl() {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().ConfigDragClickToInputText = true;  // a click on a number types it
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

ImGuiOnOpenGl::~ImGuiOnOpenGl() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

bool interface_at(double x_px, double y_px) {
  const ImVec2 at{static_cast<float>(x_px), static_cast<float>(y_px)};
  for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
    const bool takes_mouse = (window->Flags & ImGuiWindowFlags_NoMouseInputs) == 0;
    if (window->WasActive && !window->Hidden && takes_mouse && window->OuterRectClipped.Contains(at)) return true;
  }
  return false;
}

}  // namespace homolog
