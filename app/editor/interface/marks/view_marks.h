#pragma once

#include "app/editor/panels/ui_context.h"

namespace homolog {

/// Draws what lies over a view's picture: letters, scale bar, cross-hair, handles, ring and figures of a drag,
/// landmarks, ruler, hints.
void draw_view_marks(const UiContext& ui, ViewKind kind, ImDrawList& draw);

/// Draws what the mesh's colours mean, at the lower left of a view, above `bottom_px`. Nothing where each vertex has
/// its hue.
void draw_view_legend(const UiContext& ui, const RectPx& view, float bottom_px, ImDrawList& draw);

}  // namespace homolog
