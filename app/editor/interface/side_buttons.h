#pragma once

#include "app/editor/panels/ui_context.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

/// The six buttons that turn a camera to a side, in a row that begins at `x_px`, a button each `step_px`; a click sends
/// `LookCommand{side}`. `hint` ends the tooltip.
template <class LookCommand>
void draw_side_buttons(const UiContext& ui, float x_px, float y_px, float step_px, const char* hint, Outbox& out) {
  for (std::size_t i = 0; i < side_names.size(); ++i) {
    const std::string letter(1, side_letters[i]);
    ImGui::SetCursorPos({x_px + step_px * static_cast<float>(i), y_px});
    if (icon_button(ui.theme, letter.c_str(), side_names[i],
                    format("Look from %s (Shift+%s)%s", side_names[i], letter.c_str(), hint), {}, false, 24))
      out.send(LookCommand{static_cast<LookFrom>(i)});
  }
}

}  // namespace homolog
