#pragma once

#include "app/editor/panels/ui_context.h"

namespace homolog {

/// The lines of the measurements whose eyes are open, each with its value, over the 3D view.
void draw_measurement_marks(const UiContext& ui, const ViewMap& map, ImDrawList& draw);

}  // namespace homolog
