#include "app/editor/widgets/imgui_context.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
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
  io.BackendLanguageUserData = &memory_;
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

ControlsMemory& controls_memory() {
  return *static_cast<ControlsMemory*>(ImGui::GetIO().BackendLanguageUserData);
}

void begin_controls() {
  ControlsMemory& memory = controls_memory();
  memory.last_controls = std::exchange(memory.controls, {});
  if (!menus_open()) memory.searched.clear();
  memory.keys.begin_frame();
}

bool menus_open() {
  return ImGui::GetCurrentContext()->OpenPopupStack.Size > 0;
}

bool close_menus() {
  if (!menus_open()) return false;
  ImGui::ClosePopupToLevel(0, true);
  return true;
}

void erase_searched() {
  std::string& text = controls_memory().searched;
  // A letter of UTF-8 ends with the byte before it that is none of those that go on with one.
  while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U) text.pop_back();
  if (!text.empty()) text.pop_back();
  key_focus().start_again();
}

bool close_menus_beside(double x_px, double y_px) {
  const ImVec2 at{static_cast<float>(x_px), static_cast<float>(y_px)};
  const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
  controls_memory().menu_closed = 0;
  for (const ImGuiPopupData& popup : open)
    if (popup.Window == nullptr || popup.Window->OuterRectClipped.Contains(at)) return false;
  if (open.Size == 0) return false;
  controls_memory().menu_closed = open[0].PopupId;
  return close_menus();
}

void look_for_letters(const std::string& text) {
  constexpr unsigned first_private = 0xE000, last_private = 0xF8FF, not_utf8 = 0xFFFD, beyond_imgui = 0x10000;
  for (const char* at = text.data(); *at != 0;) {
    if ((static_cast<unsigned char>(*at) & 0x80U) == 0) {
      ++at;
      continue;
    }
    unsigned letter = 0;
    at += std::max(1, ImTextCharFromUtf8(&letter, at, text.data() + text.size()));
    const bool icon = letter >= first_private && letter <= last_private;
    if (icon || letter == 0 || letter == not_utf8 || letter >= beyond_imgui) continue;
    if (ImGui::GetFont()->FindGlyphNoFallback(static_cast<ImWchar>(letter)) == nullptr)
      controls_memory().unknown_letters.insert(letter);
  }
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
