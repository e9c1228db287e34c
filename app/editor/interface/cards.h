#pragma once

#include "app/editor/panels/ui_context.h"

namespace homolog {

/// A card at the right of the views, above `bottom_px`, which end_card() raises to the card's upper edge.
void begin_card(const UiContext& ui, const char* id, float& bottom_px, ImU32 edge);
void end_card(const UiContext& ui, float& bottom_px);

/// The guide to the first case, while it is shown.
void draw_guide(const UiContext& ui, float& bottom_px, Outbox& out);

}  // namespace homolog
