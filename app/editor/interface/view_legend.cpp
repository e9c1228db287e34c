#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "app/editor/interface/marks/view_marks.h"
#include "app/editor/scene/mesh_colouring.h"
#include "app/editor/widgets/widgets.h"

// What the mesh's colours mean, in a view: the panel's legend may be out of sight.

namespace homolog {

namespace {

/// Colours that have a name each, one under the other.
struct NamedColour {
  Rgb colour;
  std::string name;
};

/// As many as there is room for; the last row says how many are left.
std::vector<NamedColour> named_colours(const Legend& legend, std::size_t most) {
  std::vector<NamedColour> all;
  for (std::size_t k = 0; k < legend.names.size(); ++k) all.push_back({legend.colours[k], legend.names[k]});
  if (legend.has_confirmed) all.push_back({{1, 1, 1}, "confirmed"});
  if (legend.has_outliers) all.push_back({outlier_grey, "the scan lacks this part"});
  if (all.size() <= most) return all;
  if (most == 0) return {};
  const std::size_t left = all.size() - most + 1;
  all.resize(most - 1);
  all.push_back({outlier_grey, format("and %zu more", left)});
  return all;
}

}  // namespace

static float legend_width(const UiContext& ui, const RectPx& view) {
  return std::min(static_cast<float>(ui.theme.px(176)), view.width - 2 * ui.theme.px(8));
}

void draw_view_legend(const UiContext& ui, const RectPx& view, float bottom_px, ImDrawList& draw) {
  const Theme& theme = ui.theme;
  const Colouring colouring = shown_colouring(ui.state);
  const auto& show = ui.state.preferences.show;
  const bool coloured = show.surface || show.outline || show.wireframe;
  if (colouring == Colouring::vertex_hue || colouring == Colouring::structure || !ui.has_shape() || ui.making_shown() ||
      !coloured)
    return;
  const Legend legend = colouring_legend(ui.shown(), colouring);
  const bool scale = legend.names.empty();
  // Names take room that a small view has not; a scale is low.
  if (!scale && view.height < theme.px(300)) return;
  // The letter in the middle of the left edge stays free.
  const float middle = view.y + view.height / 2 + theme.px(16);
  const float pad = theme.px(8), row = theme.px(18), side = theme.px(10);
  const float title_px = theme.px(20), scale_px = scale ? theme.px(26) : 0;
  const float width = legend_width(ui, view), room = bottom_px - middle - title_px - scale_px - 2 * pad + theme.px(4);
  if (width < theme.px(100) || room < (scale ? 0 : 2 * row)) return;
  const auto names = named_colours(legend, static_cast<std::size_t>(std::clamp(room / row, 0.0f, 8.0f)));
  const float height = title_px + scale_px + row * static_cast<float>(names.size()) + 2 * pad - theme.px(4);
  const ImVec2 low{view.x + pad, std::floor(bottom_px - height)};
  draw.AddRectFilled(low, {low.x + width, low.y + height}, with_alpha(palette::surface, 0.8f), theme.px(4));
  ImVec2 at{low.x + pad, low.y + pad / 2};
  text_at(draw, theme.small, at, palette::text, kind_of(colouring).title);
  at.y += title_px;
  if (scale) draw_legend_scale(draw, theme, legend, at, width - 2 * pad, palette::text);
  at.y += scale_px;
  std::vector<std::string> all;
  for (const NamedColour& one : names) all.push_back(one.name);
  ImGui::PushFont(theme.small);
  for (const auto& [colour, name] : names) {
    const auto& [r, g, b] = colour;
    colour_swatch(draw, theme, {at.x, std::floor(at.y + (row - side) / 2)}, side,
                  ImGui::ColorConvertFloat4ToU32({r, g, b, 1}));
    text_at(draw, theme.small, {at.x + side + theme.px(6), std::floor(at.y + (row - theme.small->FontSize) / 2)},
            palette::text, shortened_among(name, all, width - 2 * pad - side - theme.px(6)));
    at.y += row;
  }
  ImGui::PopFont();
}

}  // namespace homolog
