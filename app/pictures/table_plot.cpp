#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "app/pictures/plates.h"
#include "app/pictures/plots.h"
#include "core/base/text/listed.h"
#include "core/base/text/short_names.h"
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

/// A text in lines that are no wider, at its blanks.
std::vector<std::string> wrapped_words(const std::string& text, double room_mm, double size_pt) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (lines.empty() || text_width_mm(longer, size_pt) > room_mm)
      lines.push_back(word);
    else
      lines.back() = longer;
  }
  return lines;
}

/// The names of places across as they fit side by side: as they are, else in up to three lines, else shortened.
std::vector<std::string> names_across(const std::vector<std::string>& names, const PageBox& area, double width_mm) {
  constexpr double apart_mm = 1;
  constexpr std::size_t most_lines = 3;
  const double room = area.width / static_cast<double>(names.size());
  bool fit = true;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const double half = text_width_mm(names[k], axis_pt) / 2, middle = area.x + room * (static_cast<double>(k) + 0.5);
    const double next = k + 1 < names.size() ? text_width_mm(names[k + 1], axis_pt) / 2 : 0;
    fit = fit && half + next + apart_mm / 2 <= room && middle - half >= 0 && middle + half <= width_mm;
  }
  if (fit) return names;
  const auto fits = [&](const std::string& text) {
    const auto lines = wrapped_words(text, room - apart_mm, axis_pt);
    return lines.size() <= most_lines && std::all_of(lines.begin(), lines.end(), [&](const std::string& line) {
             return text_width_mm(line, axis_pt) <= room - apart_mm;
           });
  };
  std::vector<std::string> shown;
  for (const std::string& name : names) {
    std::string text;
    for (const std::string& line : wrapped_words(shortened_among(name, names, fits), room - apart_mm, axis_pt))
      text += (text.empty() ? "" : "\n") + line;
    shown.push_back(std::move(text));
  }
  return shown;
}

constexpr double legend_mm = 5, legend_pt = 7;

/// The colours' names, in as many rows as the page needs. Gives how high they are.
double add_legend(Page& page, const std::vector<std::string>& groups) {
  constexpr double mark_mm = 4, apart_mm = 2, row_mm = 4;
  const double most = page.width_mm - 2 * apart_mm - 1;
  std::vector<std::string> shown;
  for (const std::string& group : groups)
    shown.push_back(shortened_among(group, groups,
                                    [&](const std::string& text) { return text_width_mm(text, legend_pt) <= most; }));
  std::vector<std::size_t> row_ends;  // the last row has the last groups
  double used = apart_mm;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const double width = text_width_mm(shown[k], legend_pt) + apart_mm + mark_mm;
    if (k > 0 && used + width > page.width_mm + 3) row_ends.push_back(k), used = apart_mm;
    used += width;
  }
  row_ends.push_back(groups.size());
  for (std::size_t row = 0; row < row_ends.size(); ++row) {
    double at = page.width_mm - apart_mm;
    const double y = row_mm * static_cast<double>(row);
    for (std::size_t k = row_ends[row]; k-- > (row == 0 ? 0 : row_ends[row - 1]);) {
      page.add_text(at, y + 4, shown[k], PageText::Anchor::end, legend_pt);
      at -= text_width_mm(shown[k], legend_pt) + apart_mm;
      page.add_mark({at, y + 3}, 0.9, plot_colours[k]);
      at -= mark_mm;
    }
  }
  return legend_mm + row_mm * static_cast<double>(row_ends.size() - 1);
}

}  // namespace

std::size_t rows_without_values(const TextTable& table, const TablePlot& shown) {
  std::size_t count = 0;
  for (const auto& row : table.rows) {
    bool lacks = false;
    for (const std::string& name : {shown.x, shown.y, shown.by.empty() ? shown.x : shown.by})
      if (const auto column = plot_column(table, name); column) lacks = lacks || is_missing(row[*column]);
    count += lacks ? 1 : 0;
  }
  return count;
}

Result<Page> table_plot(const TextTable& table, const TablePlot& shown, double width_mm) {
  constexpr double plot_height_mm = 70;
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
  const double legend = shown.by.empty() ? 0 : add_legend(page, groups);
  PlotAxis across = is_named ? PlotAxis{title_of(shown.x), -0.5, static_cast<double>(names.size()) - 0.5, false, names}
                             : axis_of(title_of(shown.x), x);
  const PlotAxis up = axis_of(title_of(shown.y), y);
  PageBox box{0, legend, width_mm, plot_height_mm};
  if (is_named) {
    const PageBox area = Plot::area_in(box, across, up);
    across.names = names_across(names, area, width_mm);
    box.height += area.height - Plot::area_in(box, across, up).height;  // what more lines take
  }
  page.height_mm = legend + box.height;
  Plot plot(page, box, across, up);
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
