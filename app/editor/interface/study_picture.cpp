#include "app/editor/interface/study_picture.h"

#include <algorithm>
#include <cmath>

#include "app/editor/widgets/widgets.h"
#include "core/base/pictures/caption_sizes.h"
#include "render/hued_shapes.h"

namespace homolog {

StudyCells study_cells(const ModelsState& state, StudyPicture what, float width_px, float height_px) {
  const StudyModel& model = *state.made.model;
  const RectPx area{0, 0, width_px, height_px};
  if (what == StudyPicture::gallery) {
    StudyCells all{gallery_grid(model.names.size(), area), {}, model.names};
    for (std::size_t k = 0; k < model.names.size(); ++k)
      all.shapes.push_back(std::make_shared<const Points>(model.shape(k)));
    return all;
  }
  constexpr Eigen::Index most_modes = 3;
  const Eigen::Index modes = std::min(most_modes, model.model.modes());
  StudyCells cells;
  cells.grid = {area, 3, static_cast<int>(modes), static_cast<std::size_t>(3 * modes)};
  const double total = model.components->variances().sum();
  for (Eigen::Index mode = 0; mode < modes; ++mode) {
    const double share = 100 * model.model.variances[mode] / total;
    for (const double deviations : {-3.0, 0.0, 3.0}) {
      cells.shapes.push_back(std::make_shared<const Points>(mode_shape(model.model, mode, deviations)));
      cells.names.push_back(deviations < 0   ? format("Mode %td (%.1f %%), \xe2\x88\x92"
                                                        "3\xe2\x88\x9a\xce\xbb",
                                                      mode + 1, share)
                            : deviations > 0 ? "+3\xe2\x88\x9a\xce\xbb"
                                             : "mean");
    }
  }
  return cells;
}

void draw_cell_name(ImDrawList& draw, const Theme& theme, const RectPx& cell, const std::string& name,
                    const std::vector<std::string>& names) {
  const float inset = theme.px(8);
  ImGui::PushFont(theme.body);
  const std::string shown = shortened_among(name, names, cell.width - 2 * inset);
  ImGui::PopFont();
  shadowed_text(draw, theme.body, {cell.x + inset, cell.y + inset}, palette::mark, shown);
}

void draw_cell_scale(ImDrawList& draw, const Theme& theme, const RectPx& cell, double mm_per_px) {
  const double length_mm = scale_bar_mm(mm_per_px, 0.4 * cell.width);
  const auto length_px = static_cast<float>(std::round(length_mm / mm_per_px));
  const float inset = theme.px(8), tick = theme.px(4);
  const float x = cell.x + inset, y = std::round(cell.y + cell.height - theme.px(14));
  const float thick = theme.px(1);
  draw.AddLine({x, y}, {x + length_px, y}, palette::mark, thick);
  for (const float end : {x, x + length_px}) draw.AddLine({end, y - tick}, {end, y + thick}, palette::mark, thick);
  shadowed_text(draw, theme.small, {x + length_px + inset, std::round(y - theme.small->FontSize / 2)}, palette::mark,
                format("%g mm", length_mm));
}

void draw_study_captions(ImDrawList& draw, const Theme& theme, const ModelsState& state, const StudyCells& cells) {
  for (std::size_t k = 0; k < cells.names.size(); ++k)
    draw_cell_name(draw, theme, cells.grid.cell(k), cells.names[k], cells.names);
  RectPx cell = cells.grid.cell(0);
  const RectPx shape = caption_room(theme.scale).left_of(cell);
  const double mm_per_px = 2 * shown_radius_mm(state.gallery.camera) / std::min(shape.width, shape.height);
  cell.height = cells.grid.area.height - cell.y;  // at the lower left of all
  draw_cell_scale(draw, theme, cell, mm_per_px);
}

}  // namespace homolog
