#include "app/pictures/page.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "app/pictures/page_font.h"
#include "core/base/encoding/base64.h"
#include "core/base/files/files.h"
#include "core/base/pictures/picture_io.h"
#include "core/base/pictures/picture_module.h"
#include "core/base/text/text.h"

// A page, and what SVG makes of it.

namespace homolog {

namespace {

/// A number as it is written into files, the same in every locale; ends without zeros.
std::string decimal(double value) {
  const double rounded = std::round(value * 1000) / 1000 + 0.0;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), rounded, std::chars_format::fixed, 3).ptr;
  std::string number(text.data(), end);
  while (number.ends_with('0')) number.pop_back();
  if (number.ends_with('.')) number.pop_back();
  return number == "-0" ? "0" : number;
}

std::string svg_colour(const Rgb& colour) {
  std::array<char, 8> text{};
  const auto part = [&](std::size_t k) { return static_cast<unsigned>(std::lround(255 * colour[k])); };
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", part(0), part(1), part(2));
  return text.data();
}

/// Text inside of an element. What no XML may hold becomes a blank.
std::string as_xml(const std::string& text) {
  std::string xml;
  const bool is_whole = is_utf8(text);
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    xml += c == '&'                    ? "&amp;"
           : c == '<'                  ? "&lt;"
           : c == '>'                  ? "&gt;"
           : code < 0x20               ? " "
           : !is_whole && code >= 0x80 ? "\xEF\xBF\xBD"  // the replacement character
                                       : std::string(1, c);
  }
  return xml;
}

std::string svg_attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + decimal(value) + '"';
}

std::string svg_of(const PagePath& path) {
  std::string svg = "<path d=\"";
  for (std::size_t k = 0; k < path.points_mm.size(); ++k)
    svg += (k == 0 ? "M" : "L") + decimal(path.points_mm[k].x()) + ' ' + decimal(path.points_mm[k].y());
  const bool filled = path.line_mm <= 0;
  svg += filled ? "Z\" fill=\"" + svg_colour(path.colour) + '"'
                : "\" fill=\"none\" stroke=\"" + svg_colour(path.colour) + '"';
  if (!filled) svg += svg_attribute("stroke-width", path.line_mm) + " stroke-linejoin=\"round\"";
  return svg + "/>\n";
}

std::string svg_of(const PageText& text) {
  static constexpr std::array<const char*, 3> anchors{"start", "middle", "end"};
  return "<text" + svg_attribute("x", text.at_mm.x()) + svg_attribute("y", text.at_mm.y()) +
         svg_attribute("font-size", text.size_pt * 25.4 / 72) + " fill=\"" + svg_colour(text.colour) +
         "\" text-anchor=\"" + anchors[static_cast<std::size_t>(text.anchor)] + "\">" + as_xml(text.text) + "</text>\n";
}

}  // namespace

void Page::add_text(double x_mm, double y_mm, std::string text, PageText::Anchor anchor, double size_pt) {
  texts.push_back({{x_mm, y_mm}, std::move(text), anchor, size_pt, ink});
}

void Page::add_line(std::vector<Eigen::Vector2d> points_mm, double line_mm) {
  paths.push_back({std::move(points_mm), ink, line_mm});
}

void Page::add_box(double x_mm, double y_mm, double width, double height, const Rgb& colour) {
  paths.push_back(
      {{{x_mm, y_mm}, {x_mm + width, y_mm}, {x_mm + width, y_mm + height}, {x_mm, y_mm + height}}, colour, 0});
}

void Page::add_mark(const Eigen::Vector2d& at_mm, double radius_mm, const Rgb& colour, int corners) {
  PagePath mark{{}, colour, 0};
  for (int k = 0; k < corners; ++k) {
    const double turn = 2 * std::numbers::pi * k / corners;
    mark.points_mm.emplace_back(at_mm + radius_mm * Eigen::Vector2d(std::sin(turn), -std::cos(turn)));
  }
  paths.push_back(std::move(mark));
}

bool is_page_name(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  return ending == ".svg" || ending == ".pdf";
}

Result<std::string> page_as_svg(const Page& page) {
  std::string svg =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"" +
      decimal(page.width_mm) + "mm\" height=\"" + decimal(page.height_mm) + "mm\" viewBox=\"0 0 " +
      decimal(page.width_mm) + ' ' + decimal(page.height_mm) +
      "\" font-family=\"Inter, Helvetica, Arial, sans-serif\">\n";
  const std::string size = svg_attribute("width", page.width_mm) + svg_attribute("height", page.height_mm);
  if (!page.transparent) svg += "<rect" + size + " fill=\"" + svg_colour(page.ground) + "\"/>\n";
  if (page.shapes) {
    const auto module = picture_module();
    if (!module) return fail(module.error());
    const auto png = (*module)->encode(*page.shapes, "shapes.png");
    if (!png) return fail(png.error());
    svg += "<image" + size + " preserveAspectRatio=\"none\" xlink:href=\"data:image/png;base64," + to_base64(*png) +
           "\"/>\n";
  }
  for (const PagePath& path : page.paths) svg += svg_of(path);
  for (const PageText& text : page.texts) svg += svg_of(text);
  return svg + "</svg>\n";
}

Result<void> write_page(const Page& page, const std::filesystem::path& path) {
  if (!is_page_name(path)) {
    const auto picture = page_as_picture(page);
    if (!picture) return fail(picture.error());
    return write_picture(*picture, path);
  }
  const auto bytes = lower_case(path.extension().string()) == ".svg" ? page_as_svg(page) : page_as_pdf(page);
  if (!bytes) return fail(bytes.error());
  return write_whole_file(path, *bytes);
}

}  // namespace homolog
