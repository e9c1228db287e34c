#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <memory>

#include "app/pictures/page.h"
#include "app/pictures/page_font.h"

// A page as pixels: FreeType fills letters, lines and areas alike.

namespace homolog {

namespace {

/// Fills areas on a picture.
class PixelPen {
 public:
  PixelPen(Picture& picture, double px_per_mm) : picture_(picture), px_per_mm_(px_per_mm) {
    FT_Init_FreeType(&library_);
  }
  ~PixelPen() { FT_Done_FreeType(library_); }
  PixelPen(const PixelPen&) = delete;
  PixelPen& operator=(const PixelPen&) = delete;

  void draw(const PagePath& path) {
    colour_ = path.colour;
    if (path.line_mm <= 0) return add(path.points_mm), fill();
    for (std::size_t k = 1; k < path.points_mm.size(); ++k) {
      const Eigen::Vector2d a = path.points_mm[k - 1], b = path.points_mm[k];
      if ((b - a).norm() < 1e-9) continue;
      const Eigen::Vector2d along = (b - a).normalized();
      const Eigen::Vector2d side = path.line_mm / 2 * Eigen::Vector2d(-along.y(), along.x());
      add({a + side, b + side, b - side, a - side});
    }
    fill();
  }

  void draw(const PageText& text) {
    colour_ = text.colour;
    Eigen::Vector2d at = text.at_mm;
    at.x() -= static_cast<double>(text.anchor) / 2 * text_width_mm(text.text, text.size_pt);
    const double mm = text.size_pt / 1000 * 25.4 / 72;
    for (const PageGlyph& glyph : glyphs_of(text.text)) {
      for (const GlyphStep& step : outline_of(glyph)) {
        const auto there = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
          return at + mm * Eigen::Vector2d(p.x(), -p.y());
        };
        if (step.kind == GlyphStep::Kind::move) end_contour();
        if (step.kind == GlyphStep::Kind::curve) {
          add_point(there(step.control_1), FT_CURVE_TAG_CUBIC);
          add_point(there(step.control_2), FT_CURVE_TAG_CUBIC);
        }
        add_point(there(step.to), FT_CURVE_TAG_ON);
      }
      at.x() += mm * glyph.advance;
    }
    end_contour();
    fill();
  }

 private:
  void add_point(const Eigen::Vector2d& mm, int tag) {
    const auto fine = [](double px) { return static_cast<FT_Pos>(std::lround(64 * px)); };
    points_.push_back({fine(mm.x() * px_per_mm_), fine(picture_.height - mm.y() * px_per_mm_)});
    tags_.push_back(static_cast<char>(tag));
  }
  void end_contour() {
    const auto last = static_cast<short>(points_.size() - 1);
    if (!points_.empty() && (ends_.empty() || ends_.back() != last)) ends_.push_back(last);
  }
  void add(const std::vector<Eigen::Vector2d>& area) {
    for (const Eigen::Vector2d& point : area) add_point(point, FT_CURVE_TAG_ON);
    end_contour();
  }

  /// A run of pixels that are covered, y from below.
  static void paint(int y, int count, const FT_Span* spans, void* self) {
    auto& pen = *static_cast<PixelPen*>(self);
    for (int k = 0; k < count; ++k)
      for (int x = spans[k].x; x < spans[k].x + spans[k].len; ++x) pen.paint(x, y, spans[k].coverage);
  }
  void paint(int x, int y_from_below, unsigned coverage) {
    const int y = picture_.height - 1 - y_from_below;
    if (x < 0 || y < 0 || x >= picture_.width || y >= picture_.height) return;
    std::uint8_t* pixel =
        picture_.rgba.data() +
        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width) + static_cast<std::size_t>(x));
    const unsigned below = pixel[3] * (255 - coverage) / 255, alpha = coverage + below;
    if (alpha == 0) return;
    for (std::size_t c = 0; c < 3; ++c)
      pixel[c] = static_cast<std::uint8_t>(
          (static_cast<unsigned>(std::lround(255 * colour_[c])) * coverage + pixel[c] * below + alpha / 2) / alpha);
    pixel[3] = static_cast<std::uint8_t>(alpha);
  }

  void fill() {
    FT_Outline outline{};
    outline.n_contours = static_cast<short>(ends_.size());
    outline.n_points = static_cast<short>(points_.size());
    outline.points = points_.data();
    outline.tags = tags_.data();
    outline.contours = ends_.data();
    FT_Raster_Params how{};
    how.flags = FT_RASTER_FLAG_AA | FT_RASTER_FLAG_DIRECT | FT_RASTER_FLAG_CLIP;
    how.gray_spans = paint;
    how.user = this;
    how.clip_box = {0, 0, picture_.width, picture_.height};
    if (!ends_.empty()) FT_Outline_Render(library_, &outline, &how);
    points_.clear();
    tags_.clear();
    ends_.clear();
  }

  Picture& picture_;
  double px_per_mm_;
  FT_Library library_ = nullptr;
  Rgb colour_{};
  std::vector<FT_Vector> points_;
  std::vector<char> tags_;
  std::vector<short> ends_;
};

}  // namespace

Result<Picture> page_as_picture(const Page& page) {
  Picture picture;
  if (page.shapes) {
    picture = *page.shapes;
  } else {
    picture.width = static_cast<int>(std::lround(page.width_mm / 25.4 * page.dpi));
    picture.height = static_cast<int>(std::lround(page.height_mm / 25.4 * page.dpi));
    picture.rgba.resize(4 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
      picture.rgba[i] = page.transparent ? 0
                        : i % 4 == 3     ? 255
                                         : static_cast<std::uint8_t>(std::lround(255 * page.ground[i % 4]));
  }
  PixelPen pen(picture, picture.width / page.width_mm);
  for (const PagePath& path : page.paths) pen.draw(path);
  for (const PageText& text : page.texts) pen.draw(text);
  return picture;
}

}  // namespace homolog
