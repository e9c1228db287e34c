#include "app/editor/state/layout.h"

#include <algorithm>
#include <cmath>

namespace homolog {

namespace {
// Layout units, on a grid of 4.
constexpr float top_bar_height = 44, tool_strip_width = 48, status_height = 28;
}  // namespace

std::optional<ViewKind> Layout::view_at(double x_px, double y_px) const {
  for (const ViewKind kind : all_views)
    if (image(kind).contains(x_px, y_px)) return kind;
  return std::nullopt;
}

Layout make_layout(float width_px, float height_px, float scale, const LayoutWishes& wishes) {
  const auto px = [scale](float units) { return std::round(units * scale); };
  Layout layout;
  layout.scale = scale;
  const float body_top = px(top_bar_height);
  const float body_height = std::max(height_px - body_top - px(status_height), 0.0f);
  const float panel = wishes.panel_open ? std::min(px(layout_units::panel_width), width_px / 2) : 0.0f;
  layout.top_bar = {0, 0, width_px, body_top};
  layout.status_line = {0, body_top + body_height, width_px, px(status_height)};
  if (wishes.models) {
    layout.models = {0, body_top, width_px, body_height};
    layout.panel = {width_px - std::min(px(layout_units::panel_width), width_px / 3), body_top, 0,
                    body_height};  // where notices end
    return layout;
  }
  layout.tool_strip = {0, body_top, px(tool_strip_width), body_height};
  layout.panel = {width_px - panel, body_top, panel, body_height};

  const float left = px(tool_strip_width);
  const float width = std::max(width_px - panel - left, 0.0f);
  const auto place = [&](ViewKind kind, float x, float y, float w, float h) {
    const float header = std::min(px(layout_units::header_height), h);
    layout.headers[index_of(kind)] = {x, y, w, header};
    layout.images[index_of(kind)] = {x, y + header, w, h - header};
  };
  if (wishes.maximised) {
    place(*wishes.maximised, left, body_top, width, body_height);
    return layout;
  }
  const float half_width = std::floor((width - px(layout_units::gap)) / 2),
              half_height = std::floor((body_height - px(layout_units::gap)) / 2);
  const float right_x = left + half_width + px(layout_units::gap),
              lower_y = body_top + half_height + px(layout_units::gap);
  place(ViewKind::axial, left, body_top, half_width, half_height);
  place(ViewKind::sagittal, right_x, body_top, left + width - right_x, half_height);
  place(ViewKind::coronal, left, lower_y, half_width, body_top + body_height - lower_y);
  place(ViewKind::space, right_x, lower_y, left + width - right_x, body_top + body_height - lower_y);
  return layout;
}

}  // namespace homolog
