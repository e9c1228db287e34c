#pragma once

#include <imgui.h>

#include <string>

#include "app/editor/widgets/drawn_items.h"

namespace homolog {

/// A control that is taken down by its rectangle, within a clipping rectangle; px of the window.
struct NotedBox {
  DrawnItem::Kind kind = DrawnItem::Kind::text;
  std::string label, value;
  ImVec2 low, high, clip_low, clip_high;
  bool hovered = false, at_keys = false;
};
void note_box(const NotedBox& box);

}  // namespace homolog
