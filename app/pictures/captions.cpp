#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/pictures/pictures.h"
#include "core/base/pictures/caption_sizes.h"
#include "core/base/text/short_names.h"

// What is written on pictures: names and scale bars, where no shape lies.

namespace homolog {

namespace {

constexpr double name_pt = 8, small_pt = 7, inset_mm = 1;
constexpr Rgb light_ink{0.9f, 0.91f, 0.92f};

void add_scale_bar(Page& page, double x_mm, double y_mm, double longest_mm, double page_mm_per_mm, bool from_right) {
  const double length = scale_bar_mm(1 / page_mm_per_mm, longest_mm), shown = length * page_mm_per_mm;
  const std::string text = figure(length) + " mm";
  constexpr double tick = 0.6, apart = 1;
  const double x = from_right ? x_mm - shown - apart - text_width_mm(text, small_pt) : x_mm;
  page.add_line({{x, y_mm}, {x + shown, y_mm}});
  for (const double end : {x, x + shown}) page.add_line({{end, y_mm - tick}, {end, y_mm + tick}});
  page.add_text(x + shown + apart, y_mm + 0.35 * small_pt * 25.4 / 72, text, PageText::Anchor::start, small_pt);
}

/// As shortened_among(), but of a difference, "A less B, side", the sign and the side stay, and both names are cut
/// alike.
std::string short_caption(const std::string& name, const std::vector<std::string>& names, const TextFits& fits) {
  const std::string minus = " \xe2\x88\x92 ", text = shortened_among(name, names, fits);
  const std::size_t at = name.find(minus), side = name.rfind(", ");
  if (at == std::string::npos || text.find(minus) != std::string::npos) return text;
  const std::size_t from = at + minus.size(), end = side == std::string::npos || side < from ? name.size() : side;
  const auto cut_to = [](const std::string& part, std::ptrdiff_t most) {
    return shortened(part, [&](const std::string& shorter) {
      return std::count_if(shorter.begin(), shorter.end(),
                           [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }) <= most;
    });
  };
  constexpr std::ptrdiff_t least = 3;
  for (std::ptrdiff_t letters = std::ssize(name); letters >= least; --letters)
    if (const std::string shorter = cut_to(name.substr(0, at), letters) + minus +
                                    cut_to(name.substr(from, end - from), letters) + name.substr(end);
        fits(shorter))
      return shorter;
  return text;
}

}  // namespace

MontageOptions print_options(double width_mm) {
  MontageOptions options;
  options.width_mm = width_mm;
  options.width_px = static_cast<int>(std::lround(width_mm / 25.4 * 300));
  options.light = options.captions = true;
  return options;
}

std::string figure(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  std::string figures = text.str();
  if (figures.starts_with('-')) figures.replace(0, 1, "\xe2\x88\x92");
  return figures;
}

Page captioned(MadePicture made, const MontageOptions& options) {
  Page page;
  page.dpi = 72 / name_pt * made.text_px;
  const double mm = options.width_mm > 0 ? options.width_mm / options.width_px : 25.4 / page.dpi;
  page.width_mm = mm * made.picture.width;
  page.height_mm = mm * made.picture.height;
  page.transparent = options.transparent;
  if (!options.light && !options.transparent) {
    page.ground = dark_ground;
    page.ink = light_ink;
  }
  std::vector<std::string> names;
  for (const PictureCell& one : made.cells) names.push_back(one.name);
  for (const PictureCell& one : made.cells) {
    const double x = mm * one.x + inset_mm, y = mm * one.y + 1.2 * name_pt * 25.4 / 72;
    double room = mm * one.width - 2 * inset_mm;
    if (one.mm_per_px > 0) room /= 2;
    const auto fits = [&](const std::string& text) { return text_width_mm(text, name_pt) <= room; };
    page.add_text(x, y, short_caption(one.name, names, fits), PageText::Anchor::start, name_pt);
    if (one.mm_per_px > 0)
      add_scale_bar(page, mm * (one.x + one.width) - 4 * inset_mm, y - 1, mm * one.width / 5, mm / one.mm_per_px, true);
  }
  const double strip_mm = mm * made.strip_px;
  if (made.mm_per_px > 0 && strip_mm > 0 && !made.cells.empty())
    add_scale_bar(page, inset_mm, page.height_mm - strip_mm + 0.75 * name_pt * 25.4 / 72,
                  0.4 * mm * made.cells.front().width, mm / made.mm_per_px, false);
  page.shapes = std::move(made.picture);
  return page;
}

}  // namespace homolog
