#pragma once

#include "app/editor/panels/ui_context.h"

namespace homolog {

/// A window in the middle with a title, before a darkened background; height 0 fits what is in it. False when its
/// cross was clicked; end_dialog() follows either way.
bool begin_dialog(const UiContext& ui, const char* title, float width_units, float height_units);
void end_dialog();

void draw_file_dialog(const UiContext& ui, const FileDialog& dialog, Outbox& out);

}  // namespace homolog
