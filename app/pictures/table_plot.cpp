#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "app/pictures/plates.h"
#include "app/pictures/plots.h"
#include "core/base/text/listed.h"
#include "core/base/text/text.h"

// The columns of any table as a plot for print.

namespace homolog {

namespace {

/// A row that has all values.
struct PlotRow {
  std::string x, by;
  double y = 0;
};

Result<std::size_t> plot_column(const TextTable& table, const std::string& name) {
  const auto found = std::find(table.columns.begin(), table.columns.end(), name);
  if (found == table.columns.end())
    return fail("", "has no column " + name + "; it has " + listed(table.columns, ", "));
  return static_cast<std::size_t>(found - table.columns.begin());
}

std::optional<double> plot_number(const std::string& cell) {
  const auto number = as_number<double>(cell);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

Result<std::vector<PlotRow>> plot_rows(const TextTable& table, const TablePlot& shown) {
  const auto x = plot_column(table, shown.x), y = plot_column(table, shown.y);
  if (!x) return fail(x.error());
  if (!y) return fail(y.error());
  const auto by = shown.by.empty() ? Result<std::size_t>(*x) : plot_column(table, shown.by);
  if (!by) return fail(by.error());
  std::vector<PlotRow> rows;
  for (std::size_t k = 0; k < table.rows.size(); ++k) {
    const auto& cells = table.rows[k];
    if (is_missing(cells[*x]) || is_missing(cells[*y]) || is_missing(cells[*by])) continue;
    const auto number = plot_number(cells[*y]);
    if (!number)
      return fail("", "has \"" + cells[*y] + "\" in line " + std::to_string(table.lines[k]) + " where " + shown.y +
                          " should be a number; name a column of numbers with --y");
    rows.push_back({cells[*x], shown.by.empty() ? "" : cells[*by], *number});
  }
  if (rows.empty()) return fail("", "has no row with " + shown.x + " and " + shown.y + "; complete it");
  return rows;
}

/// Words in the order of their first rows, each once.
std::vector<std::string> words_in_column(const std::vector<PlotRow>& rows, std::string PlotRow::*word) {
  std::vector<std::string> words;
  std::set<std::string> seen;
  for (const PlotRow& row : rows)
    if (seen.insert(row.*word).second) words.push_back(row.*word);
  return words;
}

std::size_t place_of(const std::vector<std::string>& words, const std::string& word) {
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin());
}

/// An axis that holds the values with some room.
PlotAxis axis_of(const std::string& title, const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double room = *high > *low ? 0.06 * (*high - *low) : std::max(1e-9, 0.1 * std::abs(*high));
  return {title, *low - room, *high + room};
}

/// The mean of a group as a bar, with its standard error.
void add_mean(Plot& plot, double place, const std::vector<double>& values, const Rgb& colour) {
  if (values.size() < 2) return;
  const auto count = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / count;
  for (const double value : values) squares += (value - mean) * (value - mean);
  plot.add_line({{place - 0.09, mean}, {place + 0.09, mean}}, colour);
  plot.add_error(place, mean, std::sqrt(squares / (count - 1) / count), colour);
}

}  // namespace

Result<Page> table_plot(const TextTable& table, const TablePlot& shown, double width_mm) {
  constexpr double plot_height_mm = 70, legend_mm = 5, legend_pt = 7;
  const auto rows = plot_rows(table, shown);
  if (!rows) return fail(rows.error());
  std::vector<double> x, y;
  for (const PlotRow& row : *rows) {
    y.push_back(row.y);
    if (const auto number = plot_number(row.x)) x.push_back(*number);
  }
  const bool is_named = x.size() < rows->size();  // one word, and all are names
  const auto names = is_named ? words_in_column(*rows, &PlotRow::x) : std::vector<std::string>();
  const auto groups = words_in_column(*rows, &PlotRow::by);
  const std::size_t most = plot_colours.size();
  if (groups.size() > most || (is_named && names.size() > 20))
    return fail("", "has " + std::to_string(groups.size() > most ? groups.size() : names.size()) + " groups in " +
                        (groups.size() > most ? shown.by : shown.x) +
                        ", more than can be told apart; name another column");
  Page page;
  page.width_mm = width_mm;
  page.height_mm = plot_height_mm + (shown.by.empty() ? 0 : legend_mm);
  double at = width_mm - 2;
  for (std::size_t k = groups.size(); !shown.by.empty() && k-- > 0;) {
    page.add_text(at, 4, groups[k], PageText::Anchor::end, legend_pt);
    at -= text_width_mm(groups[k], legend_pt) + 2;
    page.add_mark({at, 3}, 0.9, plot_colours[k]);
    at -= 4;
  }
  PlotAxis across = is_named ? PlotAxis{title_of(shown.x), -0.5, static_cast<double>(names.size()) - 0.5, false, names}
                             : axis_of(title_of(shown.x), x);
  Plot plot(page, {0, page.height_mm - plot_height_mm, width_mm, plot_height_mm}, across,
            axis_of(title_of(shown.y), y));
  const double step = 0.8 / static_cast<double>(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::vector<double>> of_name(names.size());
    std::vector<Eigen::Vector2d> dots;
    for (const PlotRow& row : *rows) {
      if (row.by != groups[g]) continue;
      if (!is_named) {
        dots.emplace_back(*plot_number(row.x), row.y);
        continue;
      }
      auto& values = of_name[place_of(names, row.x)];
      // Side by side, spread evenly whatever their number.
      const double spread = std::fmod(0.618 * static_cast<double>(values.size()), 1) - 0.5;
      const double middle = static_cast<double>(place_of(names, row.x)) - 0.4 + step * (static_cast<double>(g) + 0.5);
      dots.emplace_back(middle + 0.4 * step * spread - 0.1 * step, row.y);
      values.push_back(row.y);
    }
    plot.add_dots(dots, plot_colours[g]);
    for (std::size_t k = 0; k < names.size(); ++k)
      add_mean(plot, static_cast<double>(k) - 0.4 + step * (static_cast<double>(g) + 0.9), of_name[k], plot_colours[g]);
  }
  return page;
}

}  // namespace homolog
