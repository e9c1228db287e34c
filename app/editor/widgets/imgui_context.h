#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "app/editor/widgets/key_focus.h"

namespace homolog {

/// A number while it is typed: its control, what stands there, and what stood there before.
struct TypedNumber {
  unsigned item = 0;  ///< ImGui's id; 0: none
  std::string text, before;
};

/// The controls' memory from one frame to the next, beside what ImGui does. One in each ImGui context.
struct ControlsMemory {
  std::set<unsigned> unknown_letters;  ///< letters to show that no font has, code points
  std::uint64_t section_shown = 0;     ///< EditorState::section_wanted that the panel has scrolled to
  unsigned menu_closed = 0;            ///< ImGui's id of the menu that the press that goes on has closed
  bool pointer_by_keys = false;        ///< keys move the pointer, so it is drawn
  std::vector<RectPx> controls;        ///< the seen part of each control that was drawn in this frame so far
  std::vector<RectPx> last_controls;   ///< those of the frame before: no tooltip should lie on them
  TypedNumber typed;
  std::vector<std::string> refusals;  ///< refusals of typed numbers, until somebody says them
  std::string searched;               ///< the text typed into the list or menu that is open
  KeyFocus keys;
};
/// Returns the memory of the current context.
ControlsMemory& controls_memory();

/// Begins a frame of controls; after ImGui's has begun.
void begin_controls();

/// ImGui without anything that draws, for as long as this lives.
class ImGuiAlone {
 public:
  ImGuiAlone();
  ~ImGuiAlone();
  ImGuiAlone(const ImGuiAlone&) = delete;
  ImGuiAlone& operator=(const ImGuiAlone&) = delete;

 private:
  ControlsMemory memory_;
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

/// Whether a menu or a list is open over the window.
bool menus_open();
/// Closes the menus and lists that are open over the window; true where there were some.
bool close_menus();
/// The same where they do not lie at that px.
bool close_menus_beside(double x_px, double y_px);
/// Takes the last letter of what was typed into the open list away.
void erase_searched();
/// Takes down letters of a text (UTF-8) that the fonts do not have.
void look_for_letters(const std::string& text);

/// Whether a window of ImGui that takes the mouse lies at a px, as of the last frame.
bool interface_at(double x_px, double y_px);

/// Ends a frame whose drawing was broken off by an exception, so that the next can begin.
void end_broken_frame();

}  // namespace homolog
