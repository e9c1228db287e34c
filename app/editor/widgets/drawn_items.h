#pragma once

#include <string>
#include <vector>

#include "app/editor/state/layout.h"

struct ImVec2;

namespace homolog {

/// A control or a text of one frame, for whoever operates or checks the window without looking at it: the tests.
struct DrawnItem {
  enum class Kind { button, toggle, choice, track, number, field, section, row, list, area, text, tip };
  Kind kind = Kind::text;
  std::string name;      ///< as a person reads it, without its icon: "Save as…"; of a text the text
  std::string path;      ///< the parts of the window that it lies in, then its name: "side panel/Regions/hilum/factor"
  std::string pattern;   ///< the same with a name that the case gave replaced by what it names: "…/<region>/factor"
  std::string value;     ///< the value shown: "5.0 ×", "on"; empty where it shows none
  std::string tip;       ///< said on hover: what it does, or why it is disabled
  RectPx rect;           ///< px of the window
  RectPx seen;           ///< the part of it that nothing clips; without size where there is none
  RectPx clip;           ///< the room that it may draw in
  unsigned layer = 0;    ///< the window, dialog or card that it lies in; those of one layer do not cover each other
  bool scrolls = false;  ///< lies in a list or panel that is longer than its room, and moves up and down with it
  bool enabled = true;
  bool hovered = false;  ///< the pointer is on it, with nothing over it
  bool at_keys = false;  ///< marked as what the keys operate

  bool is_control() const { return kind != Kind::text && kind != Kind::tip; }
};

/// Takes down what is drawn, while it lives. One at a time, in the current ImGui context.
class DrawnItems {
 public:
  DrawnItems();
  ~DrawnItems();
  DrawnItems(const DrawnItems&) = delete;
  DrawnItems& operator=(const DrawnItems&) = delete;

  /// Returns the items of the latest frame, in the order in which they were drawn.
  const std::vector<DrawnItem>& items() const { return items_; }
  /// Forgets them; call it before each frame.
  void clear() { items_.clear(); }

 private:
  friend void enter_part(const std::string& name, const char* of);
  friend void leave_part();
  friend void note_item(DrawnItem item);
  std::vector<DrawnItem> items_;
  std::vector<std::string> path_, pattern_;
};

// For the functions that draw controls and texts (widgets.h) and parts of the window. They do nothing where nobody
// takes anything down.

bool notes_items();
/// Everything drawn up to leave_part() lies in the part of that name; `of` says what gave the name, where the case did.
void enter_part(const std::string& name, const char* of = nullptr);
void leave_part();
/// An item whose kind, name, value, tip, rectangles and state are set.
void note_item(DrawnItem item);
/// The control that ImGui made last. `label` is ImGui's, with an icon and "##…" perhaps.
void note_control(DrawnItem::Kind kind, const std::string& label, const std::string& value, const std::string& tip);
/// A text within a clipping rectangle.
void note_text(const std::string& text, ImVec2 low, ImVec2 high, ImVec2 clip_low, ImVec2 clip_high,
               DrawnItem::Kind kind = DrawnItem::Kind::text);

}  // namespace homolog
