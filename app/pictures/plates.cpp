#include "app/pictures/plates.h"

#include <algorithm>
#include <cmath>

#include "app/pictures/plots.h"
#include "core/base/numbers/index.h"
#include "core/base/text/short_names.h"
#include "core/base/text/text.h"
#include "core/model/measures/groups.h"

// Plates for print: shapes with what was measured of them, and plots.

namespace homolog {

namespace {

constexpr double narrow_mm = 120;  // a page of one column
constexpr double plot_mm = 55, scored_mm = 62;
constexpr double colour_bar_left = 0.42;  ///< of the page

/// Where a direction looks from, as captions say it.
std::string side_name(const Vec3& from) {
  for (const char* name : {"anterior", "posterior", "left", "right", "superior", "inferior"})
    if ((direction_from_name(name).value() - from).norm() < 1e-6) return name;
  return figure(from.x()) + ", " + figure(from.y()) + ", " + figure(from.z());
}

/// Two cells, from both sides.
void add_sides(std::vector<MontageCell>& cells, const Mesh& mesh, const std::string& name,
               const std::shared_ptr<const std::vector<Rgb>>& colours, const MontageOptions& options) {
  for (const double side : {1.0, -1.0}) {
    const Vec3 from = side * options.from;
    cells.push_back({mesh, (name.empty() ? "" : name + ", ") + side_name(from), from, colours});
  }
}

std::shared_ptr<const std::vector<Rgb>> bone(const Mesh& mesh) {
  return std::make_shared<const std::vector<Rgb>>(index(mesh.points.rows()), mesh_colour);
}

/// Cells with a colour bar, and `below_mm` more for plots.
Result<Page> plate(const std::vector<MontageCell>& cells, int columns, const ColourScale& scale, double below_mm,
                   MontageOptions options) {
  constexpr double beside_scale_bar_mm = 3;
  options.strip_mm = colour_bar_mm - beside_scale_bar_mm + below_mm;
  auto made = montage(cells, columns, options);
  if (!made) return fail(made.error());
  Page page = captioned(std::move(*made), options);
  add_colour_bar(
      page,
      {colour_bar_left * page.width_mm, page.height_mm - below_mm - colour_bar_mm, 0.54 * page.width_mm, colour_bar_mm},
      scale);
  return page;
}

double mode_spread(const ShapeModel& model, Eigen::Index mode) {
  return model.variances[mode] > 0 ? std::sqrt(model.variances[mode]) : 1;
}

/// The subject's coordinates, those of the training shapes behind them.
void plot_coordinates(Page& page, const PageBox& box, const ShapeModel& model, const ShapeScore& score,
                      const std::string& name) {
  const Eigen::Index modes = std::min<Eigen::Index>(model.modes(), page.width_mm < narrow_mm ? 5 : 12);
  std::vector<Eigen::Vector2d> training, own;
  double most = 3;
  for (Eigen::Index mode = 0; mode < modes; ++mode) {
    const auto number = static_cast<double>(mode + 1);
    for (Eigen::Index k = 0; k < model.scores.cols(); ++k)
      training.emplace_back(number, model.scores(mode, k) / mode_spread(model, mode));
    own.emplace_back(number, score.modes[mode]);
  }
  for (const auto* some : {&training, &own})
    for (const Eigen::Vector2d& one : *some) most = std::max(most, std::ceil(std::abs(one.y())));
  constexpr double row_mm = 4.2;
  const PageBox below{box.x, box.y + 2 * row_mm + 1, box.width, box.height - 2 * row_mm - 1};
  Plot plot(page, below, {"Mode", 0.5, static_cast<double>(modes) + 0.5, true},
            {"Coordinate (standard deviations)", -most, most});
  plot.add_dots(training, plot_grey, 0.5);
  plot.add_dots(own, plot_orange, 1.1, 4);
  const double y = box.y + 3.4;
  page.add_mark({1.6, y - 1}, 0.5, plot_grey);
  page.add_text(3, y, "training shapes");
  const double next = 3 + text_width_mm("training shapes", 8) + 5, room = box.width - next - 4;
  page.add_mark({next, y - 1}, 1.1, plot_orange, 4);
  page.add_text(next + 2, y, shortened(name, [&](const std::string& text) { return text_width_mm(text, 8) <= room; }));
  std::string said = "Distance " + figure(score.distance) + ", residual " + figure(score.residual_mm) + " mm";
  if (score.percentile) said += ", percentile " + figure(*score.percentile);
  page.add_text(1, y + row_mm, said);
}

/// The title of a scale of groups, with as much of the first one's name as the page has room for.
std::string title_of_outward(const std::vector<GroupMean>& groups, double width_mm) {
  const auto title = [](const std::string& name) { return "Outward of the mean of " + name + " (mm)"; };
  const auto fits = [&](const std::string& name) {
    return text_width_mm(title(name), 8) <= (1 - colour_bar_left) * width_mm;
  };
  std::vector<std::string> names;
  for (const GroupMean& group : groups) names.push_back(group.name);
  const std::string name = shortened_among(groups.front().name, names, fits);
  return name.empty() ? "Outward (mm)" : title(name);
}

}  // namespace

Result<Page> map_page(const Mesh& mesh, const VertexScalars& values, const std::string& property,
                      const std::vector<double>& range, const MontageOptions& options) {
  const ColourScale scale = scale_for({values}, property, range);
  std::vector<MontageCell> cells;
  add_sides(cells, mesh, "", scale.of(values), options);
  return plate(cells, 2, scale, 0, options);
}

Result<Page> groups_page(const std::vector<GroupMean>& groups, const std::shared_ptr<const Topology>& topology,
                         const std::vector<double>& range, const MontageOptions& options) {
  const Mesh first{topology, groups.front().mean};
  std::vector<VertexScalars> outward;
  for (std::size_t k = 1; k < groups.size(); ++k)
    outward.push_back(outward_mm(first, groups[k].mean - groups.front().mean));
  const ColourScale scale = scale_for(outward, "outward_mm", range);
  const auto named_mean = [](const GroupMean& group) {
    return group.name + " (n = " + std::to_string(group.shapes) + ")";
  };
  std::vector<MontageCell> cells;
  for (std::size_t k = 1; k < groups.size(); ++k) {
    const Mesh other{topology, groups[k].mean};
    cells.push_back({first, named_mean(groups.front()), options.from, bone(first)});
    cells.push_back({other, named_mean(groups[k]), options.from, bone(other)});
    add_sides(cells, first, groups[k].name + " \xe2\x88\x92 " + groups.front().name, scale.of(outward[k - 1]), options);
  }
  ColourScale titled = scale;
  titled.title = title_of_outward(groups, options.width_mm);
  return plate(cells, options.width_mm < narrow_mm ? 2 : 4, titled, 0, options);
}

Result<Page> score_page(const ShapeModel& model, const ShapeScore& score, const std::string& name,
                        const std::vector<double>& range, const MontageOptions& options) {
  if (!model.topology) return fail("", "is a model of points without faces, which cannot be drawn");
  if (model.scores.cols() == 0 || model.modes() == 0)
    return fail("",
                "has no coordinates of its training shapes, so a subject cannot be shown among them; make it anew "
                "with model");
  const Mesh mean{model.topology, points_of(model.mean)}, subject{model.topology, score.aligned};
  const ColourScale scale = scale_for({score.z}, "z", range);
  std::vector<MontageCell> cells{{mean, "Mean of the model", options.from, bone(mean)},
                                 {subject, name, options.from, bone(subject)}};
  add_sides(cells, subject, "z", scale.of(score.z), options);
  auto page = plate(cells, options.width_mm < narrow_mm ? 2 : 4, scale, scored_mm, options);
  if (page) plot_coordinates(*page, {0, page->height_mm - scored_mm, page->width_mm, scored_mm}, model, score, name);
  return page;
}

Result<Page> model_plots(const ShapeModel& model, double width_mm) {
  if (model.scores.cols() == 0 || model.modes() == 0)
    return fail("", "has no coordinates of its training shapes, so these cannot be plotted; make it anew with model");
  const bool narrow = width_mm < narrow_mm;
  Page page;
  page.width_mm = width_mm;
  page.height_mm = narrow ? 2 * plot_mm : plot_mm;
  const double half = narrow ? width_mm : width_mm / 2;
  std::vector<Eigen::Vector2d> shares;
  double sum = 0;
  const double total = model.variances.sum();
  for (Eigen::Index mode = 0; mode < model.modes(); ++mode)
    shares.emplace_back(static_cast<double>(mode + 1), (sum += model.variances[mode]) * 100 / total);
  Plot variance(page, {0, 0, half - 2, plot_mm}, {"Modes", 0.5, static_cast<double>(model.modes()) + 0.5, true},
                {"Share of the model's variance (%)", 0, 100});
  variance.add_line(shares, plot_blue);
  variance.add_dots(shares, plot_blue);
  std::vector<Eigen::Vector2d> shapes;
  double most = 3;
  const bool one_mode = model.modes() < 2;
  for (Eigen::Index k = 0; k < model.scores.cols(); ++k) {
    shapes.emplace_back(model.scores(0, k) / mode_spread(model, 0),
                        one_mode ? 0 : model.scores(1, k) / mode_spread(model, 1));
    most = std::max(most, std::ceil(shapes.back().cwiseAbs().maxCoeff()));
  }
  Plot modes(page, {narrow ? 0 : half + 2, narrow ? plot_mm : 0, half - 2, plot_mm},
             {"Mode 1 (standard deviations)", -most, most},
             {one_mode ? "One mode" : "Mode 2 (standard deviations)", -most, most});
  modes.add_dots(shapes, plot_blue);
  return page;
}

Result<Page> measure_plots(const TextTable& table, double width_mm) {
  struct Measure {
    const char *column, *title;
  };
  static constexpr std::array<Measure, 3> measures{{{"compactness", "Compactness (share)"},
                                                    {"generalization_rms", "Generalisation error (mm)"},
                                                    {"specificity_rms", "Specificity error (mm)"}}};
  const bool narrow = width_mm < narrow_mm;
  Page page;
  page.width_mm = width_mm;
  page.height_mm = narrow ? 3 * plot_mm : plot_mm;
  const auto numbers = [&](const std::string& column) -> Result<std::vector<double>> {
    const auto found = std::find(table.columns.begin(), table.columns.end(), column);
    if (found == table.columns.end())
      return fail("", "has no column " + column + "; give a table that evaluate --csv wrote");
    std::vector<double> values;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const auto value = as_number<double>(table.rows[row][found - table.columns.begin()]);
      if (!value || !std::isfinite(*value))
        return fail("", "holds no number in line " + std::to_string(table.lines[row]) + ", column " + column);
      values.push_back(*value);
    }
    return values;
  };
  if (table.rows.empty()) return fail("", "holds no rows; give a table that evaluate --csv wrote");
  for (std::size_t k = 0; k < measures.size(); ++k) {
    const auto values = numbers(measures[k].column), errors = numbers(std::string(measures[k].column) + "_se");
    if (!values) return fail(values.error());
    if (!errors) return fail(errors.error());
    double most = 0;
    std::vector<Eigen::Vector2d> points;
    for (std::size_t m = 0; m < values->size(); ++m) {
      points.emplace_back(static_cast<double>(m + 1), (*values)[m]);
      most = std::max(most, (*values)[m] + (*errors)[m]);
    }
    const double part = width_mm / 3, at = static_cast<double>(k);
    const PageBox box = narrow ? PageBox{0, at * plot_mm, width_mm, plot_mm} : PageBox{at * part, 0, part - 2, plot_mm};
    Plot plot(page, box, {"Modes", 0.5, static_cast<double>(points.size()) + 0.5, true},
              {measures[k].title, 0, k == 0 ? 1 : 1.05 * most});
    plot.add_line(points, plot_blue);
    for (std::size_t m = 0; m < points.size(); ++m)
      plot.add_error(points[m].x(), points[m].y(), (*errors)[m], plot_blue);
    plot.add_dots(points, plot_blue);
  }
  return page;
}

}  // namespace homolog
