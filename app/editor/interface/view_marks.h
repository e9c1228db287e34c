#pragma once

#include "app/editor/panels/ui_context.h"

namespace homolog {

/// What lies over a view's picture: letters, scale bar, cross-hair, handles, ring and figures of a drag, landmarks,
/// ruler, hints.
void draw_view_marks(const UiContext& ui, ViewKind kind, ImDrawList& draw);

}  // namespace homolog
