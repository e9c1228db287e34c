#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/dialogs.h"
#include "app/editor/state/layout.h"
#include "app/editor/widgets/theme.h"
#include "core/model/measures/evaluation.h"

namespace homolog {

/// A measure over the number of modes, or of rounds, as a plot: values joined by a line, standard errors as bars.
struct Plot {
  std::string title, unit;  ///< "Generalisation", "mm"
  std::string axis;         ///< the title of the values' axis: "RMS distance, mm"
  Measures measures;        ///< entry k is at first + k modes
  double factor = 1;        ///< shown = factor · measured
  int decimals = 2;
  std::optional<double> whole;    ///< the axis ends here, where it is known
  std::optional<int> mark_modes;  ///< the model's own number of modes
  const char* over = "modes";     ///< the things counted along the plot, in the plural
  int first = 1;
  std::size_t room = 0;    ///< entries that there is room for at least, as they come one after the other
  bool from_zero = true;   ///< else the axis begins near the least value, so that small differences are seen
  bool has_errors = true;  ///< the standard errors are known
};
/// Compactness, generalisation and specificity.
std::vector<Plot> plots_of(const Evaluation& evaluation);

/// Round values for the marks of an axis from 0 to at least `most`, at most `count` steps.
std::vector<double> axis_marks(double most, int count);

/// The same from about `least`, which is below `most`.
std::vector<double> axis_marks_between(double least, double most, int count);

/// Draws a plot; the value under the pointer is shown beside its point.
void draw_plot(ImDrawList& draw, const Theme& theme, const RectPx& rect, const Plot& plot,
               std::optional<ImVec2> pointer);
/// All plots side by side over the whole picture.
void draw_plots_picture(const Theme& theme, const Evaluation& evaluation, const PictureOptions& options,
                        ImDrawList& draw);

}  // namespace homolog
