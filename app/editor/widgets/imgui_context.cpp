#include "app/editor/widgets/imgui_context.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <utility>

#include "app/editor/state/key_codes.h"

namespace homolog {

namespace {

/// Which of our keys is which of those that ImGui's fields know.
void map_keys(ImGuiIO& io) {
  for (const auto& [imgui, ours] :
       {std::pair(ImGuiKey_Tab, key::tab), std::pair(ImGuiKey_LeftArrow, key::left),
        std::pair(ImGuiKey_RightArrow, key::right), std::pair(ImGuiKey_UpArrow, key::up),
        std::pair(ImGuiKey_DownArrow, key::down), std::pair(ImGuiKey_PageUp, key::page_up),
        std::pair(ImGuiKey_PageDown, key::page_down), std::pair(ImGuiKey_Home, key::home),
        std::pair(ImGuiKey_End, key::end), std::pair(ImGuiKey_Insert, key::insert),
        std::pair(ImGuiKey_Delete, key::del), std::pair(ImGuiKey_Backspace, key::backspace),
        std::pair(ImGuiKey_Space, static_cast<int>(' ')), std::pair(ImGuiKey_Enter, key::enter),
        std::pair(ImGuiKey_Escape, key::escape), std::pair(ImGuiKey_KeyPadEnter, key::keypad_enter)})
    io.KeyMap[imgui] = ours;
  for (const auto& [imgui, ours] : {std::pair(ImGuiKey_A, 'A'), std::pair(ImGuiKey_C, 'C'), std::pair(ImGuiKey_V, 'V'),
                                    std::pair(ImGuiKey_X, 'X'), std::pair(ImGuiKey_Y, 'Y'), std::pair(ImGuiKey_Z, 'Z')})
    io.KeyMap[imgui] = ours;
}

}  // namespace

ImGuiAlone::ImGuiAlone() {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.ConfigDragClickToInputText = true;  // a click on a number types it
  map_keys(io);
}

ImGuiAlone::~ImGuiAlone() {
  ImGui::DestroyContext();
}

ImGuiOnOpenGl::ImGuiOnOpenGl() {
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

ImGuiOnOpenGl::~ImGuiOnOpenGl() {
  ImGui_ImplOpenGL3_Shutdown();
}

void end_broken_frame() {
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  if (!imgui.WithinFrameScope) return;
  ImGui::ErrorCheckEndFrameRecover(nullptr);
  ImGui::EndFrame();
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
