#include "app/pictures/plots.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/pictures/pictures.h"
#include "core/mesh/colours.h"

// Plots and colour bars as vectors.

namespace homolog {

namespace {

constexpr double number_pt = axis_pt, title_pt = 8, number_mm = number_pt * 25.4 / 72;
constexpr Rgb pale{0.85f, 0.85f, 0.85f}, unknown_grey{0.75f, 0.75f, 0.75f};

Rgb on_colours(const std::vector<Rgb>& colours, double share) {
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(colours.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), colours.size() - 2);
  const auto t = static_cast<float>(place - static_cast<double>(low));
  Rgb mixed{};
  for (std::size_t k = 0; k < 3; ++k) mixed[k] = (1 - t) * colours[low][k] + t * colours[low + 1][k];
  return mixed;
}

constexpr double y_mark_mm = 7;

/// Where an axis is marked: at its names, else at round numbers, each with so much room.
std::vector<double> axis_marks(const PlotAxis& axis, double room_mm, double each_mm) {
  if (!axis.names.empty()) {
    std::vector<double> places;
    for (std::size_t k = 0; k < axis.names.size(); ++k) places.push_back(static_cast<double>(k));
    return places;
  }
  auto ticks = round_ticks(axis.low, axis.high, std::max(2, static_cast<int>(room_mm / each_mm)));
  if (axis.whole) std::erase_if(ticks, [](double tick) { return std::abs(tick - std::round(tick)) > 1e-9; });
  return ticks;
}

/// The next round number that is not below.
double round_end(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

}  // namespace

std::vector<double> round_ticks(double low, double high, int most) {
  const double least = (high - low) / std::max(1, most), power = std::pow(10, std::floor(std::log10(least)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= least * (1 - 1e-9)) step = factor * power;
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push_back(k * step + 0.0);
  return ticks;
}

PageBox Plot::area_in(const PageBox& box, const PlotAxis& x, const PlotAxis& y) {
  constexpr double above = 6, right = 3;
  std::ptrdiff_t more_lines = 0;
  for (const std::string& name : x.names) more_lines = std::max(more_lines, std::count(name.begin(), name.end(), '\n'));
  const double below = 9.5 + axis_line_mm * static_cast<double>(more_lines);
  double left = 0;
  for (const double tick : axis_marks(y, box.height - above - below, y_mark_mm))
    left = std::max(left, text_width_mm(figure(tick), number_pt));
  left += 3;
  return {box.x + left, box.y + above, box.width - left - right, box.height - above - below};
}

Plot::Plot(Page& page, const PageBox& box, const PlotAxis& x, const PlotAxis& y)
    : page_(page), area_(area_in(box, x, y)), x_(x), y_(y) {
  const double bottom = area_.y + area_.height;
  for (const double tick : axis_marks(y, area_.height, y_mark_mm)) {
    const double place = at(x.low, tick).y();
    page.paths.push_back({{{area_.x, place}, {area_.x + area_.width, place}}, pale, 0.15});
    page.add_text(area_.x - 1, place + 0.35 * number_mm, figure(tick), PageText::Anchor::end, number_pt);
  }
  for (const double tick : axis_marks(x, area_.width, 9)) {
    const double place = at(tick, y.low).x();
    page.add_line({{place, bottom}, {place, bottom + 0.8}});
    std::istringstream lines(x.names.empty() ? figure(tick) : x.names[static_cast<std::size_t>(tick)]);
    double line_y = bottom + 1.4 + number_mm;
    for (std::string line; std::getline(lines, line); line_y += axis_line_mm)
      page.add_text(place, line_y, line, PageText::Anchor::middle, number_pt);
  }
  page.add_line({{area_.x, area_.y}, {area_.x, bottom}, {area_.x + area_.width, bottom}});
  page.add_text(box.x + 1, box.y + title_pt * 25.4 / 72, y.title, PageText::Anchor::start, title_pt);
  page.add_text(area_.x + area_.width / 2, box.y + box.height - 1.2, x.title, PageText::Anchor::middle, title_pt);
}

Eigen::Vector2d Plot::at(double x, double y) const {
  const auto share = [](double value, const PlotAxis& axis) {
    return axis.high > axis.low ? std::clamp((value - axis.low) / (axis.high - axis.low), 0.0, 1.0) : 0;
  };
  return {area_.x + share(x, x_) * area_.width, area_.y + (1 - share(y, y_)) * area_.height};
}

void Plot::add_line(const std::vector<Eigen::Vector2d>& values, const Rgb& colour) {
  PagePath path{{}, colour, 0.35};
  for (const Eigen::Vector2d& value : values) path.points_mm.push_back(at(value.x(), value.y()));
  page_.paths.push_back(std::move(path));
}

void Plot::add_dots(const std::vector<Eigen::Vector2d>& values, const Rgb& colour, double radius_mm, int corners) {
  for (const Eigen::Vector2d& value : values) page_.add_mark(at(value.x(), value.y()), radius_mm, colour, corners);
}

void Plot::add_error(double x, double y, double error, const Rgb& colour) {
  const Eigen::Vector2d top = at(x, y + error), bottom = at(x, y - error), side(0.8, 0);
  page_.paths.push_back({{top, bottom}, colour, 0.2});
  for (const Eigen::Vector2d& end : {top, bottom}) page_.paths.push_back({{end - side, end + side}, colour, 0.2});
}

std::shared_ptr<const std::vector<Rgb>> ColourScale::of(const VertexScalars& values) const {
  std::vector<Rgb> shown;
  for (const double value : values)
    shown.push_back(std::isfinite(value) ? on_colours(colours, (value - low) / (high - low)) : unknown_grey);
  return std::make_shared<const std::vector<Rgb>>(std::move(shown));
}

std::string title_of(const std::string& property) {
  std::string title = property, unit;
  if (property == "z" || property.starts_with("z_")) unit = " (standard deviations)";
  for (const auto& [ending, shown] : {std::pair<std::string, const char*>{"_mm", " (mm)"},
                                      {"_mm2", " (mm\xc2\xb2)"},
                                      {"_ml", " (ml)"},
                                      {"_deg", " (\xc2\xb0)"},
                                      {"_g", " (g)"}})
    if (title.ends_with(ending) && unit.empty()) title.resize(title.size() - ending.size()), unit = shown;
  std::replace(title.begin(), title.end(), '_', ' ');
  return title + unit;
}

ColourScale scale_for(const std::vector<VertexScalars>& values, const std::string& property,
                      const std::vector<double>& range) {
  double low = 0, high = 0;
  for (const VertexScalars& some : values)
    for (const double value : some)
      if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  const bool is_signed = range.empty() ? low < 0 : range[0] < 0 && range[1] > 0;
  // On paper much is dark, and most of a surface is light enough to show its form.
  const std::vector<Rgb> much_is_dark(rising_scale().rbegin(), rising_scale().rend());
  ColourScale scale{is_signed ? diverging_scale() : much_is_dark, 0, round_end(high), false, false, title_of(property)};
  if (is_signed) scale.high = round_end(std::max(-low, high)), scale.low = -scale.high;
  if (!range.empty()) scale.low = range[0], scale.high = range[1];
  const double slack = 1e-9 * (scale.high - scale.low);
  scale.below = low < scale.low - slack;
  scale.above = high > scale.high + slack;
  return scale;
}

void add_colour_bar(Page& page, const PageBox& box, const ColourScale& scale) {
  constexpr double bar_mm = 2.6;
  constexpr int steps = 128;
  const double top = box.y + title_pt * 25.4 / 72 + 1;
  page.add_text(box.x, box.y + 0.8 * title_pt * 25.4 / 72, scale.title, PageText::Anchor::start, title_pt);
  for (int k = 0; k < steps; ++k) {
    // Each reaches under the next, so that no ground shines through between them.
    const double from = box.width * k / steps, to = std::min(box.width, box.width * (k + 1.5) / steps);
    page.add_box(box.x + from, top, to - from, bar_mm, on_colours(scale.colours, (k + 0.5) / steps));
  }
  for (const double share : {0.0, 0.5, 1.0}) {
    const double place = box.x + share * box.width, tick = scale.low + share * (scale.high - scale.low);
    page.add_line({{place, top + bar_mm}, {place, top + bar_mm + 0.6}});
    const std::string beyond = share == 0 && scale.below   ? "\xe2\x89\xa4 "
                               : share == 1 && scale.above ? "\xe2\x89\xa5 "
                                                           : "";
    page.add_text(place, top + bar_mm + 1 + number_mm, beyond + figure(tick), PageText::Anchor::middle, number_pt);
  }
}

}  // namespace homolog
