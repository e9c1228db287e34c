#pragma once

#include <string>

#include "app/editor/panels/ui_context.h"

namespace homolog {

// The sections of the side panel, each in the file panel_*.cpp of its name.
void draw_case_section(const UiContext& ui, Outbox& out);
void draw_cine_section(const UiContext& ui, Outbox& out);
void draw_structures_section(const UiContext& ui, Outbox& out);
void draw_template_section(const UiContext& ui, Outbox& out);
void draw_place_section(const UiContext& ui, Outbox& out);
void draw_contours_section(const UiContext& ui, Outbox& out);
void draw_deform_section(const UiContext& ui, Outbox& out);
void draw_correspondence_section(const UiContext& ui, Outbox& out);
void draw_measurements_section(const UiContext& ui, Outbox& out);
void draw_score_section(const UiContext& ui, Outbox& out);
void draw_export_section(const UiContext& ui, Outbox& out);
// What some of them say while they are folded.
std::string structures_in_words(const UiContext& ui);
std::string template_in_words(const UiContext& ui);
std::string placed_in_words(const UiContext& ui);
std::string contours_in_words(const UiContext& ui);
std::string recipe_in_words(const UiContext& ui);
std::string scored_by_in_words(const UiContext& ui);

}  // namespace homolog
