#pragma once

#include "app/editor/panels/ui_context.h"

namespace homolog {

/// Width of the cards: they lie beside the side panel, over the views.
float card_width(const UiContext& ui);
/// The upper edge of a card that hangs from the views' upper edge.
float top_of_cards(const UiContext& ui);
/// A card at the right of the views, above `bottom_px`, which end_card() raises to the card's upper edge. Height 0 fits
/// what is in it, a frame late: a text that grows is cut meanwhile.
/// `hangs`: the card lies below that px instead, and end_card() leaves it.
void begin_card(const UiContext& ui, const char* id, float height_px, float bottom_px, ImU32 edge, bool hangs = false);
void end_card(const UiContext& ui, float& bottom_px);

/// The guide to the first case, while it is shown.
void draw_guide(const UiContext& ui, float& bottom_px, Outbox& out);

}  // namespace homolog
