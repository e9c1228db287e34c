#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/dialogs.h"
#include "app/editor/state/layout.h"
#include "app/editor/widgets/theme.h"
#include "core/model/evaluation.h"

namespace homolog {

/// A measure over the number of modes, as a plot: values joined by a line, standard errors as bars.
struct Plot {
  std::string title, unit;  ///< "Generalisation", "mm"
  std::string axis;         ///< of the values: "RMS distance, mm"
  Measures measures;        ///< entry m − 1 is at m modes
  double factor = 1;        ///< shown = factor · measured
  int decimals = 2;
  std::optional<double> whole;    ///< the axis ends here, where it is known
  std::optional<int> mark_modes;  ///< the model's own number of modes
};
/// Compactness, generalisation and specificity.
std::vector<Plot> plots_of(const Evaluation& evaluation);

/// Round values for the marks of an axis from 0 to at least `most`, at most `count` steps.
std::vector<double> axis_marks(double most, int count);

/// Draws a plot; the value under the pointer is shown beside its point.
void draw_plot(ImDrawList& draw, const Theme& theme, const RectPx& rect, const Plot& plot,
               std::optional<ImVec2> pointer);
/// All plots side by side over the whole picture.
void draw_plots_picture(const Theme& theme, const Evaluation& evaluation, const PictureOptions& options,
                        ImDrawList& draw);

}  // namespace homolog
