#pragma once

#include <string>

#include "app/editor/panels/ui_context.h"
#include "app/editor/state/models/gallery.h"

namespace homolog {

/// The whole window, inside an ImGui frame.
void draw_interface(const UiContext& ui, Outbox& out);

// Its parts in the case mode, from top to bottom; each in a file of its own. The side panel is one of the panels.
void draw_top_bar(const UiContext& ui, Outbox& out);
void draw_tool_strip(const UiContext& ui, Outbox& out);
void draw_views(const UiContext& ui, Outbox& out);
void draw_status_line(const UiContext& ui, Outbox& out);

// Those over either mode.
void draw_dialogs(const UiContext& ui, Outbox& out);
void draw_notices(const UiContext& ui, Outbox& out);
/// Case | Models, for the bar at the top.
void draw_mode_switch(const UiContext& ui, Outbox& out);

/// The whole window in the Models mode, and its parts.
void draw_models_interface(const UiContext& ui, Outbox& out);
void draw_gallery(const UiContext& ui, const ModelsLayout& layout, Outbox& out);
void draw_model_view(const UiContext& ui, const ModelsLayout& layout, Outbox& out);

/// The line at the window's foot, in the small font; gives the y of its text. end_status_line() follows.
float begin_status_line(const UiContext& ui);
void end_status_line();
/// A warning that the status line does not hold: all of it, in lines above the line.
void draw_tall_message(const UiContext& ui, const std::string& message);

/// Work on a study's file, or on a case that is made for the study.
RunningWork study_work(const RunningJob& job);

}  // namespace homolog
