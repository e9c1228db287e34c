#pragma once

#include <imgui.h>

#include <string>

namespace homolog {

// The room of a row, for the sources of widgets.h.

/// How wide a control may be that begins at ImGui's cursor, px.
float available();
/// Text in the middle of the height of a rectangle; `align` 0 at its left edge, 1 at its right one.
void text_in(ImVec2 low, ImVec2 high, ImU32 colour, const std::string& text, float align);

}  // namespace homolog
