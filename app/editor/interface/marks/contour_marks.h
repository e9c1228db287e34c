#pragma once

#include "app/editor/panels/ui_context.h"

namespace homolog {

/// The contours of all structures that are shown: in slices those that lie in them, and where the others cross.
void draw_contours(const UiContext& ui, const ViewMap& map, ImDrawList& draw);

/// A dot on the contour that a press would hold, to draw a part of it anew. The pointer is in the view.
void draw_held_contour(const UiContext& ui, const ViewMap& map, ImDrawList& draw);

/// The curve that is being drawn, and where it began.
void draw_contour_drag(const UiContext& ui, const ContourDrag& drag, const ViewMap& map, ImDrawList& draw);

}  // namespace homolog
