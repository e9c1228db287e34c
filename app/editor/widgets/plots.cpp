#include "app/editor/widgets/plots.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

void put_text(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text) {
  text_at(draw, font, {std::round(at.x), std::round(at.y)}, colour, text);
}

/// Text as short as the value allows: 0.5, 10, 0.05.
std::string mark_text(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return format("%.*f", decimals, value);
}

/// How values lie in a plot's field.
struct Field {
  ImVec2 low, high;
  double least = 0, most = 1;
  std::size_t count = 1;

  float x(std::size_t m) const {
    const float share = count > 1 ? static_cast<float>(m) / static_cast<float>(count - 1) : 0.5f;
    const float inset = std::min((high.x - low.x) / 20, 12.0f);
    return low.x + inset + share * (high.x - low.x - 2 * inset);
  }
  float y(double value) const {
    return high.y - static_cast<float>(std::clamp((value - least) / (most - least), 0.0, 1.0)) * (high.y - low.y);
  }
};

void draw_axes(ImDrawList& draw, const Theme& theme, const Field& field, const std::vector<double>& marks, int first) {
  const double step = marks.size() > 1 ? marks[1] - marks[0] : 1;
  for (const double mark : marks) {
    const float y = std::round(field.y(mark));
    draw.AddLine({field.low.x, y}, {field.high.x, y}, mark == 0 ? palette::faint : palette::line);
    const std::string text = mark_text(mark, step);
    const ImVec2 size = text_size(theme.small, text);
    put_text(draw, theme.small, {field.low.x - theme.px(6) - size.x, y - size.y / 2}, palette::dim, text);
  }
  const float room = text_size(theme.small, "00").x + theme.px(8);
  const auto every = static_cast<std::size_t>(
      std::max(1.0f, std::ceil(room * static_cast<float>(field.count) / (field.high.x - field.low.x))));
  for (std::size_t m = 0; m < field.count; m += every) {
    const std::string text = std::to_string(first + static_cast<int>(m));
    const float x = field.x(m);
    draw.AddLine({x, field.high.y}, {x, field.high.y + theme.px(3)}, palette::faint);
    put_text(draw, theme.small, {x - text_size(theme.small, text).x / 2, field.high.y + theme.px(4)}, palette::dim,
             text);
  }
}

void draw_values(ImDrawList& draw, const Theme& theme, const Field& field, const Plot& plot) {
  std::vector<ImVec2> line;
  const float cap = theme.px(2), thick = std::max(theme.scale, 1.0f);
  for (std::size_t m = 0; m < plot.measures.size(); ++m) {
    const Measured& value = plot.measures[m];
    const float x = field.x(m);
    line.push_back({x, field.y(plot.factor * value.mean)});
    if (!plot.has_errors) continue;
    const float low = field.y(plot.factor * (value.mean - value.standard_error));
    const float high = field.y(plot.factor * (value.mean + value.standard_error));
    const ImU32 bar = with_alpha(palette::accent, 0.45f);
    draw.AddLine({x, low}, {x, high}, bar, thick);
    draw.AddLine({x - cap, low}, {x + cap + 1, low}, bar, thick);
    draw.AddLine({x - cap, high}, {x + cap + 1, high}, bar, thick);
  }
  draw.AddPolyline(line.data(), static_cast<int>(line.size()), palette::accent, 0, 1.5f * thick);
  for (std::size_t m = 0; m < line.size(); ++m) {
    const bool marked = plot.mark_modes == plot.first + static_cast<int>(m);
    draw.AddCircleFilled(line[m], theme.px(marked ? 4 : 2), marked ? palette::text : palette::accent);
  }
}

/// "3 modes: 1.25 ± 0.10 mm"
std::string value_text(const Plot& plot, std::size_t entry) {
  const Measured& value = plot.measures[entry];
  const int count = plot.first + static_cast<int>(entry);
  const std::string over = count == 1 ? std::string(plot.over).substr(0, std::strlen(plot.over) - 1) : plot.over;
  const std::string at = format("%d %s: ", count, over.c_str());
  const double mean = plot.factor * value.mean, error = plot.factor * value.standard_error;
  if (!plot.has_errors) return format("%s%.*f %s", at.c_str(), plot.decimals, mean, plot.unit.c_str());
  // A share goes from nothing to all: there a deviation that does not fit on one side would mislead.
  return plot.whole ? format("%s%.*f %s (%.0f to %.0f)", at.c_str(), plot.decimals, mean, plot.unit.c_str(),
                             std::max(mean - error, 0.0), std::min(mean + error, *plot.whole))
                    : format("%s%.*f \xc2\xb1 %.*f %s", at.c_str(), plot.decimals, mean, plot.decimals, error,
                             plot.unit.c_str());
}

void draw_pointed(ImDrawList& draw, const Theme& theme, const Field& field, const Plot& plot, ImVec2 pointer) {
  std::size_t nearest = 0;
  for (std::size_t m = 1; m < plot.measures.size(); ++m)
    if (std::abs(field.x(m) - pointer.x) < std::abs(field.x(nearest) - pointer.x)) nearest = m;
  const float x = field.x(nearest), y = field.y(plot.factor * plot.measures[nearest].mean);
  draw.AddLine({x, field.low.y}, {x, field.high.y}, with_alpha(palette::text, 0.35f));
  draw.AddCircle({x, y}, theme.px(5), palette::text, 0, 1.5f);
  const std::string text = value_text(plot, nearest);
  const ImVec2 size = text_size(theme.small, text);
  const float pad = theme.px(6);
  const float at_x =
      std::clamp(x - size.x / 2, field.low.x + pad, std::max(field.low.x + pad, field.high.x - size.x - pad));
  const bool below = y - field.low.y < size.y + 4 * pad;
  const float at_y = below ? std::min(y + 2 * pad, field.high.y - size.y - pad) : y - size.y - 2 * pad;
  draw.AddRectFilled({at_x - pad, at_y - pad / 2}, {at_x + size.x + pad, at_y + size.y + pad / 2}, palette::raised,
                     theme.px(4));
  put_text(draw, theme.small, {at_x, at_y}, palette::text, text);
}

/// The least of 1, 2 and 5 times a power of ten that goes into `range` at most `count` times.
double round_step(double range, int count) {
  const double rough = range / count, decade = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * decade;
  for (const double part : {5.0, 2.0, 1.0})
    if (part * decade >= rough * (1 - 1e-12)) step = part * decade;
  return step;
}

/// The marks of a plot's axis; its first and last are the axis' ends unless the plot has a `whole`.
std::vector<double> marks_of(const Plot& plot, int steps) {
  constexpr double least_share = 0.05;  // of the largest value: what an axis covers that does not begin at 0
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const Measured& value : plot.measures) {
    least = std::min(least, plot.factor * (value.mean - value.standard_error));
    most = std::max(most, plot.factor * (value.mean + value.standard_error));
  }
  if (!plot.from_zero && most > 0) return axis_marks_between(std::min(least, (1 - least_share) * most), most, steps);
  std::vector<double> marks = axis_marks(plot.whole ? *plot.whole : most, steps);
  if (plot.whole) std::erase_if(marks, [&](double mark) { return mark > *plot.whole; });
  return marks;
}

}  // namespace

std::vector<double> axis_marks(double most, int count) {
  if (!(most > 0)) most = 1;
  const double step = round_step(most, count);
  std::vector<double> marks;
  for (int k = 0; marks.empty() || marks.back() < most * (1 - 1e-9); ++k) marks.push_back(k * step);
  return marks;
}

std::vector<double> axis_marks_between(double least, double most, int count) {
  const double step = round_step(most - least, count);
  std::vector<double> marks;
  for (double k = std::floor(least / step); marks.empty() || marks.back() < most - 1e-9 * step; ++k)
    marks.push_back(k * step);
  return marks;
}

std::vector<Plot> plots_of(const Evaluation& evaluation) {
  const std::optional<int> own = evaluation.modes.empty() ? std::nullopt : std::optional(evaluation.modes.front());
  const auto of = [&](const char* name) { return *evaluation.find(name); };
  return {{.title = "Compactness",
           .unit = "%",
           .axis = "share of the variance, %",
           .measures = of("compactness"),
           .factor = 100,
           .decimals = 1,
           .whole = 100,
           .mark_modes = own},
          {.title = "Generalisation",
           .unit = "mm",
           .axis = "RMS to unseen shapes, mm",
           .measures = of("generalization_rms"),
           .decimals = 3,
           .mark_modes = own},
          {.title = "Specificity",
           .unit = "mm",
           .axis = "RMS to the nearest shape, mm",
           .measures = of("specificity_rms"),
           .decimals = 3,
           .mark_modes = own}};
}

void draw_plot(ImDrawList& draw, const Theme& theme, const RectPx& rect, const Plot& plot,
               std::optional<ImVec2> pointer) {
  const std::vector<double> marks = marks_of(plot, rect.height > static_cast<float>(theme.px(200)) ? 5 : 3);
  const float line = theme.small->FontSize;
  put_text(draw, theme.strong, {rect.x, rect.y}, palette::text, plot.title);
  const ImVec2 axis = text_size(theme.small, plot.axis);
  put_text(draw, theme.small, {rect.x + rect.width - axis.x, rect.y + theme.px(2)}, palette::dim, plot.axis);
  const Field field{{rect.x + theme.px(36), rect.y + theme.strong->FontSize + theme.px(10)},
                    {rect.x + rect.width, rect.y + rect.height - line - theme.px(8)},
                    marks.front(),
                    plot.whole ? std::max(*plot.whole, 1e-300) : marks.back(),
                    std::max<std::size_t>({plot.measures.size(), plot.room, 1})};
  draw_axes(draw, theme, field, marks, plot.first);
  if (plot.from_zero)  // else the lowest mark lies there
    put_text(draw, theme.small, {rect.x, field.high.y + theme.px(4)}, palette::dim, plot.over);
  draw.PushClipRect({field.low.x, field.low.y - theme.px(6)}, {field.high.x, field.high.y + theme.px(6)}, true);
  draw_values(draw, theme, field, plot);
  draw.PopClipRect();
  const bool inside = pointer && pointer->x >= field.low.x && pointer->x <= field.high.x && pointer->y >= field.low.y &&
                      pointer->y <= field.high.y;
  if (inside && !plot.measures.empty()) draw_pointed(draw, theme, field, plot, *pointer);
}

void draw_plots_picture(const Theme& theme, const Evaluation& evaluation, const PictureOptions& options,
                        ImDrawList& draw) {
  const auto width = static_cast<float>(options.width), height = static_cast<float>(options.height);
  if (!options.transparent)
    draw.AddRectFilled({0, 0}, {width, height}, options.light ? IM_COL32_WHITE : palette::surface);
  const std::vector<Plot> plots = plots_of(evaluation);
  const float margin = theme.px(32), part = (width - margin) / static_cast<float>(plots.size());
  for (std::size_t k = 0; k < plots.size(); ++k)
    draw_plot(draw, theme, {margin + part * static_cast<float>(k), margin, part - margin, height - 2 * margin},
              plots[k], std::nullopt);
}

}  // namespace homolog
