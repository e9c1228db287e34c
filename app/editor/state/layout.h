#pragma once

#include <array>
#include <optional>

#include "app/editor/state/view_geometry.h"

namespace homolog {

/// A rectangle of the window, px from its upper left corner.
struct RectPx {
  float x = 0, y = 0, width = 0, height = 0;
  bool contains(double px_x, double px_y) const {
    return px_x >= x && px_y >= y && px_x < x + width && px_y < y + height;
  }
  bool operator==(const RectPx&) const = default;
};

/// The lengths that every mode lays out by, on a grid of 4 layout units.
namespace layout_units {
constexpr float panel_width = 328, header_height = 28, gap = 4;
}

/// Layout units in which all controls have room.
inline constexpr int smallest_window_width = 800, smallest_window_height = 600;

/// The places of everything in the window. A view that is not shown (another one is maximised) has no size.
struct Layout {
  RectPx top_bar, tool_strip, panel, status_line;
  RectPx models;                  ///< all that the Models mode fills; has no size in the case's
  std::array<RectPx, 4> headers;  ///< title and buttons of each view
  std::array<RectPx, 4> images;   ///< the picture of each view
  float scale = 1;                ///< px a layout unit: the monitor's content scale

  const RectPx& image(ViewKind kind) const { return images[index_of(kind)]; }
  std::optional<ViewKind> view_at(double x_px, double y_px) const;
};

struct LayoutWishes {
  std::optional<ViewKind> maximised;
  bool panel_open = true;
  bool models = false;  ///< the Models mode instead of the case
};

Layout make_layout(float width_px, float height_px, float scale, const LayoutWishes& wishes);

}  // namespace homolog
