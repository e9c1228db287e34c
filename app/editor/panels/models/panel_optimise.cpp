#include <algorithm>

#include "app/editor/panels/models/models_panel.h"
#include "app/editor/widgets/plots.h"
#include "app/editor/widgets/widgets.h"

// The section Optimise of the Models mode: vertices slide so that the set gets shorter to describe.

namespace homolog {

namespace {

/// The description length over the rounds, as it comes; always of the same height.
void draw_bits(const Theme& theme, const StudyOptimisation& optimisation) {
  Plot plot{.title = "Description length",
            .unit = "bits",
            .axis = "bits over rounds",
            .over = "rounds",
            .first = 0,
            .room = static_cast<std::size_t>(GroupwiseOptions().rounds) + 1,
            .from_zero = false,
            .has_errors = false};
  for (const double bits : optimisation.bits) plot.measures.push_back({bits, 0});
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = theme.px(148);
  ImGui::Dummy({width, height});
  draw_plot(*ImGui::GetWindowDrawList(), theme, {at.x, at.y, width, height}, plot,
            ImGui::IsItemHovered() ? std::optional(ImGui::GetIO().MousePos) : std::nullopt);
}

/// "9.40 → 8.98 bits"; a dash while it is not known.
std::string change_text(const OptimisedStudy* done, double SetFigures::*figure, double factor, int decimals,
                        const char* unit) {
  if (done == nullptr || (figure != &SetFigures::bits && done->after.modes < 1)) return "\xe2\x80\x93";
  return format("%.*f \xe2\x86\x92 %.*f %s", decimals, factor * done->before.*figure, decimals,
                factor * done->after.*figure, unit);
}

std::string length_text(const OptimisedStudy* done, double OptimisedStudy::*length_mm) {
  return done == nullptr ? "\xe2\x80\x93" : format("%.2f mm", done->*length_mm);
}

/// As fitted and optimised; the same rows while nothing is known yet, so that nothing below moves.
void draw_figures(const Theme& theme, const OptimisedStudy* done) {
  const int modes = done != nullptr ? done->after.modes : 0;
  caption(theme,
          modes > 0 ? format("As fitted \xe2\x86\x92 optimised, at %d %s", modes, modes == 1 ? "mode" : "modes").c_str()
                    : "As fitted \xe2\x86\x92 optimised");
  const std::string needs = "It takes at least three shapes";
  figure(theme, "Description", change_text(done, &SetFigures::bits, 1, 2, "bits"),
         "Description length of positions and features. Fewer bits do not prove a better correspondence. Only places "
         "that somebody knows do");
  figure(theme, "Compactness", change_text(done, &SetFigures::compactness, 100, 1, "%"),
         "Share of the variance that these modes hold. " + needs);
  figure(theme, "Generalisation", change_text(done, &SetFigures::generalisation_rms, 1, 3, "mm"),
         "Each shape is left out and rebuilt by a model of the others. RMS distance of the vertices. " + needs);
  figure(theme, "Specificity", change_text(done, &SetFigures::specificity_rms, 1, 3, "mm"),
         "RMS distance of random shapes to the nearest training shape. " + needs);
  figure(theme, "Largest slide", length_text(done, &OptimisedStudy::largest_slide_mm),
         "How far a vertex of any shape slid along its surface");
  figure(theme, "Surface moved", length_text(done, &OptimisedStudy::surface_moved_mm),
         "The largest distance between the two surfaces of a shape, either way");
}

/// How far it is, or which shapes are shown; always of the same height.
void draw_progress_or_choice(const Theme& theme, const StudyOptimisation& optimisation, Outbox& out) {
  const float end_px = ImGui::GetCursorPosY() + theme.px(36) + ImGui::GetStyle().ItemSpacing.y;
  if (optimisation.runs()) {
    if (work_area(theme, "",
                  WorkShown{"Optimising", optimisation.fraction, "The shapes stay as they were fitted (Escape)"}))
      out.send(CancelOptimisation{});
  } else {
    int shown = optimisation.shown ? 1 : 0;
    if (choice(theme, "shapes", {"As fitted", "Optimised"}, shown,
               {.tips = {"Gallery, model, measures and exports use the shapes as they were fitted",
                         "Gallery, model, measures and exports use the optimised shapes. The cases stay as they are"}}))
      out.send(ShowOptimised{shown == 1});
  }
  ImGui::SetCursorPosY(std::max(ImGui::GetCursorPosY(), end_px));
}

}  // namespace

void draw_optimise_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const StudyOptimisation& optimisation = ui.state.models.made.optimisation;
  const float width = ImGui::GetContentRegionAvail().x;
  if (!optimisation.of) {
    explanation(theme,
                "Vertices slide along their own surfaces so that the set gets shorter to describe. Surfaces, named "
                "landmarks and confirmed vertices stay.");
    if (button(theme, "Optimise", "You see the description length fall. No file and no case is changed",
               ButtonOptions{.refusal = why_not_optimise(ui.state.models), .width_px = width, .primary = true}))
      out.send(StartOptimisation{});
    return;
  }
  draw_progress_or_choice(theme, optimisation, out);
  if (button(theme, "Discard", "Drops the optimised shapes. The shapes are again as they were fitted",
             optimisation.runs() ? "The shapes are being optimised." : "", width))
    out.send(DiscardOptimised{});
  draw_bits(theme, optimisation);
  draw_figures(theme, optimisation.done.get());
}

}  // namespace homolog
