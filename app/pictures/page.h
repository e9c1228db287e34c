#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/pictures/picture.h"
#include "core/base/result.h"
#include "core/mesh/colours.h"

namespace homolog {

/// Letters on a page: one line (UTF-8).
struct PageText {
  enum class Anchor { start, middle, end };
  Eigen::Vector2d at_mm = Eigen::Vector2d::Zero();  ///< the anchor's place on the baseline
  std::string text;
  Anchor anchor = Anchor::start;
  double size_pt = 8;
  Rgb colour{0, 0, 0};
};

/// Straight lines through points, or the area that they enclose.
struct PagePath {
  std::vector<Eigen::Vector2d> points_mm;
  Rgb colour{0, 0, 0};
  double line_mm = 0;  ///< 0: the area is filled
};

/// A page for print: shapes as pixels, all else as vectors. Lengths in mm from the upper left corner.
struct Page {
  double width_mm = 170, height_mm = 100, dpi = 300;
  Rgb ground{1, 1, 1}, ink{0.1f, 0.1f, 0.1f};
  bool transparent = false;       ///< no ground is drawn
  std::optional<Picture> shapes;  ///< covers the whole page
  std::vector<PagePath> paths;    ///< over the shapes, in this order
  std::vector<PageText> texts;    ///< over all

  void add_text(double x_mm, double y_mm, std::string text, PageText::Anchor anchor = PageText::Anchor::start,
                double size_pt = 8);
  void add_line(std::vector<Eigen::Vector2d> points_mm, double line_mm = 0.2);
  /// A filled rectangle from its upper left corner.
  void add_box(double x_mm, double y_mm, double width_mm, double height_mm, const Rgb& colour);
  /// A filled disc, or with four corners a diamond.
  void add_mark(const Eigen::Vector2d& at_mm, double radius_mm, const Rgb& colour, int corners = 16);
};

/// How wide a text is in the font of a page (Inter), mm.
double text_width_mm(const std::string& text, double size_pt);

/// Whether a name ends as those of pages do: .svg or .pdf.
bool is_page_name(const std::filesystem::path& path);
/// A page as SVG, whose text is text, and as PDF, whose text is text too and whose font is inside. The same page gives
/// the same bytes. Letters that Inter lacks are drawn as areas in PDF, from a font that the system has.
Result<std::string> page_as_svg(const Page& page);
Result<std::string> page_as_pdf(const Page& page);
/// A page as pixels at its own resolution.
Result<Picture> page_as_picture(const Page& page);
/// By the ending of the name: SVG, PDF, or a picture of pixels; whole or not at all.
Result<void> write_page(const Page& page, const std::filesystem::path& path);

}  // namespace homolog
