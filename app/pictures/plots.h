#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/pictures/page.h"
#include "core/base/numbers/geometry.h"

namespace homolog {

/// A rectangle of a page, mm.
struct PageBox {
  double x = 0, y = 0, width = 0, height = 0;
};

/// The range of an axis, and its title with the unit.
struct PlotAxis {
  std::string title;
  double low = 0, high = 1;
  bool whole = false;                ///< whole numbers alone are marked
  std::vector<std::string> names{};  ///< names of the places 0, 1, …, in place of numbers; '\n' parts their lines
};

/// The size of the numbers and names at axes, and how far apart the lines of a name lie.
inline constexpr double axis_pt = 7, axis_line_mm = 1.2 * axis_pt * 25.4 / 72;

/// Places for round numbers from low to high, at most `most` of them.
std::vector<double> round_ticks(double low, double high, int most);

/// A plot on a page: its axes are drawn when it is made, inside of `box` with their titles and numbers.
class Plot {
 public:
  Plot(Page& page, const PageBox& box, const PlotAxis& x, const PlotAxis& y);

  /// The box between the axes of a plot that is made so; names of several lines make the box lower.
  static PageBox area_in(const PageBox& box, const PlotAxis& x, const PlotAxis& y);

  Eigen::Vector2d at(double x, double y) const;
  void add_line(const std::vector<Eigen::Vector2d>& values, const Rgb& colour);
  void add_dots(const std::vector<Eigen::Vector2d>& values, const Rgb& colour, double radius_mm = 0.7,
                int corners = 16);
  /// From y − error to y + error.
  void add_error(double x, double y, double error, const Rgb& colour);

 private:
  Page& page_;
  PageBox area_;  ///< between the axes
  PlotAxis x_, y_;
};

/// The meaning of colours on a surface.
struct ColourScale {
  std::vector<Rgb> colours;  ///< evenly spaced from low to high
  double low = 0, high = 1;
  bool below = false, above = false;  ///< some values lie beyond the ends
  std::string title;

  /// The colour of each value; grey where it is not known (NaN).
  std::shared_ptr<const std::vector<Rgb>> of(const VertexScalars& values) const;
};
/// A scale for values, from blue over white to red about 0 where some are below 0, else from light to dark. Its ends
/// are round; `range` {low, high} gives them. The title is the property's name with its unit.
ColourScale scale_for(const std::vector<VertexScalars>& values, const std::string& property,
                      const std::vector<double>& range);
/// "doubt (mm)" of "doubt_mm".
std::string title_of(const std::string& property);
/// A bar of a scale with its title and numbers, in a box of colour_bar_mm height.
void add_colour_bar(Page& page, const PageBox& box, const ColourScale& scale);
inline constexpr double colour_bar_mm = 11;

/// Colours of plots that colour-blind eyes tell apart [Okabe and Ito 2008].
inline constexpr std::array<Rgb, 7> plot_colours{{{0.0f, 0.447f, 0.698f},
                                                  {0.835f, 0.369f, 0.0f},
                                                  {0.0f, 0.62f, 0.451f},
                                                  {0.8f, 0.475f, 0.655f},
                                                  {0.902f, 0.624f, 0.0f},
                                                  {0.337f, 0.706f, 0.914f},
                                                  {0.3f, 0.3f, 0.3f}}};
inline constexpr Rgb plot_blue{0.0f, 0.447f, 0.698f}, plot_orange{0.835f, 0.369f, 0.0f}, plot_grey{0.62f, 0.62f, 0.62f};

}  // namespace homolog
