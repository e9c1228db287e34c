#include <algorithm>

#include "app/editor/panels/ui_context.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/work/label_surfaces.h"
#include "core/case/actions/confirm.h"
#include "core/case/held_landmarks.h"
#include "core/mesh/voxels/isosurface.h"

// The automatic fit to the label map that is shown, in the section Place, and to the mesh's own surface, in the section
// Correspondence.

namespace homolog {

namespace {

/// The model whose shape comes first; true where the settings changed.
bool draw_fit_model(const UiContext& ui, FitSettings& settings, Outbox& out) {
  const Theme& theme = ui.theme;
  bool changed = false, released = false;
  caption(theme, "Shape model for the fit");
  int model = static_cast<int>(settings.model);
  if (choice(
          theme, "fit model", {"No model", "Study's", "File's"}, model,
          {.tips = {"Fits the template alone, without a model",
                    "Starts with the shape of the model of the study's other cases that is nearest to the label",
                    "Starts with the shape of a model file that is nearest to the label: .h5 or .h5.json of Homolog, "
                    "scalismo or statismo"}})) {
    settings.model = static_cast<FitModel>(model);
    changed = true;
  }
  if (settings.model == FitModel::file) {
    const std::string name = ui.state.automatic.fit_model_file.filename().string();
    const float width = ImGui::GetContentRegionAvail().x;
    if (button(theme,
               ui.state.automatic.fit_model ? shortened(name, width - theme.px(16)) : "Choose the model\xe2\x80\xa6",
               "The file of the shape model. It must have the template's numbering", {}, width))
      out.send(ShowFileDialog{FilePurpose::open_model, {}});
  }
  if (settings.model == FitModel::none) return changed;
  double beyond = 100 * settings.beyond;
  if (slider(theme, "Beyond", beyond, {0, 100, "%.0f", "%", false},
             "How far the fit leaves the model's shape: 0 % stays with it, 100 % goes all the way to the label",
             released)) {
    settings.beyond = beyond / 100;
    changed = true;
  }
  return changed;
}

std::string model_refusal(const UiContext& ui) {
  const FitSettings& settings = ui.state.automatic.fit_settings;
  const auto& study = ui.state.models.made.model;
  if (settings.model == FitModel::file) return ui.state.automatic.fit_model ? "" : "Choose the model first.";
  if (settings.model != FitModel::study) return "";
  const bool fits =
      study && ui.structure() != nullptr && study->vertices() == ui.structure()->the_template->points.rows();
  return fits ? "" : "Open a study with at least two other cases of this template first (Models).";
}

/// One label, also while all are taken together.
int fit_label(const UiContext& ui) {
  FitSettings settings = ui.state.automatic.fit_settings;
  settings.all_labels = false;
  return ui.labels().volume
             ? label_in_hand(settings, ui.labels().values, *ui.labels().volume, active_shape(ui.state, ui.document()))
             : settings.label;
}

void draw_fit_settings(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  FitSettings settings = ui.state.automatic.fit_settings;
  // While none was chosen for this map, it is the one that the mesh lies in.
  const int own = fit_label(ui);
  int label = own;
  bool changed =
      label_choice(ui, label, settings.all_labels, "Opens the label map that the template is fitted to", out);
  if (label != own) settings.label = label;
  changed |= ball_slider(ui, "Closing", settings.closing_mm, settings.all_labels ? every_label : label,
                         "Radius. Clefts of the label narrower than twice the radius are filled before the fit");
  caption(theme, "Where the fit starts");
  int start = settings.as_placed ? 1 : 0;
  if (choice(
          theme, "fit start", {"Find the place", "As placed"}, start,
          {.tips = {
               "The fit finds position, size and rotation by itself, near the patient's axes. Placed landmarks help. "
               "It never mirrors the template",
               "The fit starts where the template is now"}})) {
    settings.as_placed = start == 1;
    changed = true;
  }
  changed |= toggle(theme, "The scan cuts the organ", settings.partial,
                    "Also where a piece is missing. The fit finds what the label lacks and leaves it to the template's "
                    "shape or the model. The mesh is grey there");
  changed |= draw_fit_model(ui, settings, out);
  if (changed) out.send(SetFit{settings});
}

/// Why neither can start.
std::string busy_refusal(const UiContext& ui) {
  if (ui.work.fitter.busy()) return ui.work.fitter.refining() ? "A refinement is running." : "A fit is running.";
  return ui.state.look.playing ? "Stop the cine first." : "";
}

/// Whether a person confirmed vertices of the shown frame. What placed landmarks hold does not count: a fit goes by
/// those landmarks itself.
bool person_confirmed(const UiContext& ui) {
  Document document = *ui.snapshot().document;
  document.frame = ui.document().frame;
  const auto shown = active_shape(ui.state, document);
  return shown && confirmed_without_landmarks(*shown) != nullptr;
}

std::string fit_refusal(const UiContext& ui) {
  if (auto busy = busy_refusal(ui); !busy.empty()) return busy;
  if (!ui.labels().volume) return "Open a label map first.";
  if (ui.labels().values.empty()) return "The label map is empty.";
  if (auto other = ui.labels().refusal_at(ui.document().frame); !other.empty()) return other;
  if (person_confirmed(ui)) return "A fit moves every vertex, but you confirmed some. Free them below first.";
  if (auto refusal = model_refusal(ui); !refusal.empty()) return refusal;
  return ui.needs_shape();
}

/// Frees all that is confirmed, as one step.
void draw_free_all(const UiContext& ui, Outbox& out) {
  if (!button(ui.theme, "Free the confirmed vertices",
              "Lets every confirmed vertex go, so that the fit can move all. One step to undo", {},
              ImGui::GetContentRegionAvail().x))
    return;
  const Box bounds = bounds_of(*ui.committed_shape().points);
  out.apply(Confirm{bounds.center(), bounds.diagonal().norm(), false});
}

void draw_last_fit(const Theme& theme, const Fitted& fitted) {
  const bool partial = fitted.figures.missing_share.has_value();
  figure(theme, "Distance to the label", format("%.2f mm", fitted.figures.mean_mm),
         partial ? "Mean distance from the label to the mesh. Flat cuts through the organ do not count"
                 : "Mean distance between mesh and label, both ways");
  figure(theme, "95 % of it within", format("%.2f mm", fitted.figures.p95_mm),
         "The 95th percentile of that distance: only 5 % of the surface is farther away");
  if (partial)
    figure(theme, "Missing in the label", format("%.0f %%", 100 * *fitted.figures.missing_share),
           "Share of the mesh that lies where the label lacks the organ. The mesh is grey there");
  else
    figure(theme, "Dice", fitted.figures.dice ? format("%.3f", *fitted.figures.dice) : "\xe2\x80\x93",
           fitted.figures.dice
               ? "Overlap with the closed label. 1 means that both are the same"
               : "A mesh with a rim encloses nothing that could overlap. Its warnings say how far the rims lie apart",
           fitted.figures.dice.value_or(1) < 0.9 ? palette::amber : palette::text);
  std::string said;
  for (const auto* sentences : {&fitted.figures.warnings, &fitted.figures.remarks})
    for (const std::string& sentence : *sentences) said += (said.empty() ? "" : " ") + sentence;
  two_lines(theme, said, fitted.figures.warnings.empty() ? palette::dim : palette::amber);
}

/// How far the fit is, or how good the last one was; always of the same height, so that nothing below moves.
void draw_fit_figures(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const float end_px = ImGui::GetCursorPosY() + 3 * theme.px(22) + theme.px(36) + ImGui::GetStyle().ItemSpacing.y;
  const bool fitting = ui.work.fitter.busy() && !ui.work.fitter.refining();
  if (fitting) {
    if (work_area(theme, "",
                  WorkShown{"Fitting", ui.work.fitter.fraction(), "The mesh goes back to how it was (Escape)"}))
      out.send(CancelFit{});
  } else if (ui.labels().volume && ui.state.found.last_fit &&
             *ui.state.found.last_fit->edit.points == *ui.committed_shape().points) {
    draw_last_fit(theme, *ui.state.found.last_fit);
  }
  ImGui::SetCursorPosY(std::max(ImGui::GetCursorPosY(), end_px));
}

}  // namespace

void draw_fit(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const float width = ImGui::GetContentRegionAvail().x;
  gap(theme, 4);
  caption(theme, "Automatic fit");
  draw_fit_settings(ui, out);
  if (button(theme, "Fit to the label", "You see the mesh move. The fit is one step to undo",
             ButtonOptions{.refusal = fit_refusal(ui), .width_px = width, .primary = true})) {
    FitSettings settings = ui.state.automatic.fit_settings;
    settings.label = fit_label(ui);
    out.send(StartFit{settings});
  }
  if (ui.labels().volume && person_confirmed(ui)) draw_free_all(ui, out);
  draw_fit_figures(ui, out);
}

void draw_refinement(const UiContext& ui, Outbox& out) {
  gap(ui.theme, 4);
  const std::string busy = busy_refusal(ui);
  if (button(ui.theme, "Refine along the surface",
             "Use this when the outline is right. The template is fitted to this surface and to the placed landmarks. "
             "Then vertices move along the surface to their places on the template. The surface and confirmed "
             "vertices stay. One step to undo",
             busy.empty() ? ui.needs_shape() : busy, ImGui::GetContentRegionAvail().x))
    out.send(RefineAlongSurface{});
  std::optional<WorkShown> running;
  if (ui.work.fitter.refining())
    running = {"Refining", ui.work.fitter.fraction(), "The mesh goes back to how it was (Escape)"};
  const auto& last = ui.state.found.last_refinement;
  const bool known = last && ui.has_shape() && *last->edit.points == *ui.committed_shape().points;
  if (work_area(ui.theme, known ? last->figures.remarks.back() : "", running)) out.send(CancelFit{});
}

}  // namespace homolog
