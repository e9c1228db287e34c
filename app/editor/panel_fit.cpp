#include "app/editor/controls.h"
#include "app/editor/ui_context.h"
#include "app/editor/widgets.h"

// The automatic fit to the label map that is shown, in the section Place.

namespace homolog {

namespace {

void draw_fit_settings(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  FitSettings settings = ui.state.fit_settings;
  bool changed = label_choice(ui, settings.label), released = false;
  changed |= slider(theme, "Closing", settings.closing_mm, {0, 10, "%.1f", "mm", false},
                    "Radius: clefts of the label narrower than twice that are filled before the fit", released);
  int start = settings.as_placed ? 1 : 0;
  if (choice(
          theme, "fit start", {"Find the place", "As placed"}, start,
          {"Position, size and turn are found from the label, near the patient's axes; placed landmarks help. Never a "
           "reflection",
           "The fit starts where the template is now"})) {
    settings.as_placed = start == 1;
    changed = true;
  }
  if (changed) out.change([settings](EditorState& s) { s.fit_settings = settings; });
}

std::string fit_refusal(const UiContext& ui) {
  if (ui.label_values.empty()) return "The label map is empty.";
  if (ui.snapshot.document->shapes.contains(ui.displayed->frame) && ui.committed_shape().confirmed)
    return "Regions are confirmed, and a fit moves every landmark: release them first (C).";
  return ui.needs_shape();
}

void draw_last_fit(const Theme& theme, const FitReport& report) {
  figure(theme, "Distance to the label", format("%.2f mm, 95 %% %.2f", report.assd_mm, report.hd95_mm),
         "Mean distance of the two surfaces, both ways, and their 95th percentile");
  figure(theme, "Dice", format("%.3f", report.dice), "Overlap with the label as it was closed, 1 is all",
         report.dice < 0.9 ? palette::amber : palette::text);
  for (const std::string& remark : report.remarks) explanation(theme, remark);
}

}  // namespace

void draw_fit(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const float width = ImGui::GetContentRegionAvail().x;
  gap(theme, 4);
  caption(theme, "Automatic fit");
  if (!ui.labels) {
    if (button(theme, "Open a label map\xe2\x80\xa6", "The template can be fitted to a label without a hand", {},
               width))
      out.change([](EditorState& s) { show_file_dialog(s, FilePurpose::open_labels); });
    return;
  }
  if (ui.fitter.busy()) {
    explanation(theme, format("Fitting: %.0f %%", 100 * ui.fitter.fraction()));
    progress_bar(theme, ui.fitter.fraction());
    if (button(theme, "Cancel", "The mesh stays as it was", {}, width)) out.send(CancelFit{});
    return;
  }
  draw_fit_settings(ui, out);
  if (button(theme, "Fit to the label", "Shown as it goes on; one step to undo", fit_refusal(ui), width, true))
    out.send(StartFit{});
  if (ui.state.last_fit && ui.state.last_fit->points == ui.committed_shape().points)
    draw_last_fit(theme, *ui.state.last_fit);
}

}  // namespace homolog
