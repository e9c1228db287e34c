#pragma once

#include "app/editor/panels/ui_context.h"
#include "app/editor/state/models/gallery.h"

namespace homolog {

// Parts of the Models mode, each in a file of its own.
void draw_case_table(const UiContext& ui, const RectPx& rect, Outbox& out);
/// Below the list: what the selected case is, and what can be done with it.
void draw_case_details(const UiContext& ui, const StudyCase& one, Outbox& out);
float case_details_height(const UiContext& ui, const StudyCase& one);
void draw_models_panel(const UiContext& ui, const RectPx& rect, Outbox& out);

// Sections of the panel.
void draw_model_section(const UiContext& ui, Outbox& out);
void draw_measures_section(const UiContext& ui, Outbox& out);
void draw_optimise_section(const UiContext& ui, Outbox& out);
void draw_sizes_section(const UiContext& ui, Outbox& out);
void draw_observers_section(const UiContext& ui, Outbox& out);
void draw_suspicion_section(const UiContext& ui, Outbox& out);
void draw_study_pictures_section(const UiContext& ui, Outbox& out);

/// The name that files made of the study are called after.
std::string study_stem(const ModelsState& state);
/// The words of a button that writes what is shown, after its own tip: nothing, or that the shapes are the optimised
/// ones.
std::string of_optimised(const ModelsState& state);

}  // namespace homolog
