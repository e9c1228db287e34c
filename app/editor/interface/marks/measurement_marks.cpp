#include "app/editor/interface/marks/measurement_marks.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "app/editor/interface/marks/landmark_marks.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

void draw_measured_lines(const Theme& theme, const ViewMap& map, const MeasuredLines& measured, ImDrawList& draw) {
  const auto stroke = [&](ImU32 colour, float units) {
    for (const auto& line : measured.lines)
      for (std::size_t k = 1; k < line.size(); ++k) {
        const auto from = map.to_px(line[k - 1]), to = map.to_px(line[k]);
        if (from && to) draw.AddLine(on_screen(*from), on_screen(*to), colour, theme.px(units));
      }
  };
  // A dark rim, so that the line is seen on any colour of the mesh.
  stroke(IM_COL32(0, 0, 0, 160), 4);
  stroke(palette::accent, 2);
  constexpr std::size_t a_chain = 3;  // ends and corners are marked, the points of circles and ways are not
  for (const auto& line : measured.lines)
    for (const Vec3& p : line)
      if (const auto px = map.to_px(p); px && line.size() <= a_chain)
        draw.AddCircleFilled(on_screen(*px), theme.px(3), palette::accent);
}

}  // namespace

void draw_measurement_marks(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const auto& measured = ui.work.measurements.latest();
  if (map.is_slice() || !measured || measured->recipe != ui.state.measurements.recipe || ui.making_shown()) return;
  const auto& recipe = *measured->recipe;
  std::vector<std::pair<ImVec2, std::string>> texts;
  for (std::size_t k = 0; k < recipe.measurements.size(); ++k) {
    const RecipeStep& step = recipe.steps[recipe.measurements[k]];
    if (!ui.state.measurements.drawn.contains(step.name) || measured->lines[k].lines.empty()) continue;
    draw_measured_lines(ui.theme, map, measured->lines[k], draw);
    const auto px = map.to_px(measured->lines[k].at);
    if (px)
      texts.emplace_back(on_screen(*px), step.name + "  " + value_with_unit(*measured->numbers[k].value, step.unit));
  }
  // Above all lines, the upper one first: one that would cover another goes below it.
  std::ranges::stable_sort(texts, {}, [](const auto& one) { return one.first.y; });
  const RectPx& rect = map.rect();
  const float edge = ui.theme.px(4), aside = ui.theme.px(8);
  float free_y = static_cast<float>(rect.y) + edge;
  for (const auto& [at, text] : texts) {
    const ImVec2 size = text_size(ui.theme.strong, text);
    const float low = static_cast<float>(rect.x) + edge, high = static_cast<float>(rect.x + rect.width) - edge - size.x;
    const float y = std::max(free_y, at.y + edge);
    shadowed_text(draw, ui.theme.strong, {std::max(low, std::min(at.x + aside, high)), y}, palette::mark, text);
    free_y = y + size.y;
  }
}

}  // namespace homolog
