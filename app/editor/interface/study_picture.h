#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/editor/state/dialogs.h"
#include "app/editor/state/models/gallery.h"
#include "app/editor/widgets/theme.h"

namespace homolog {

/// Shapes in a grid, with what is written on each: a picture of a study.
struct StudyCells {
  GalleryGrid grid;
  std::vector<std::shared_ptr<const Points>> shapes;
  std::vector<std::string> names;
};
/// All shapes of the study, or the first three modes of its model, a row each: −3√λ, mean, +3√λ [Erdt 2009, Fig. 4].
/// There has to be a model.
StudyCells study_cells(const ModelsState& state, StudyPicture what, float width_px, float height_px);
/// The name of what a cell shows, one of `names`, and a scale bar at its lower left.
void draw_cell_name(ImDrawList& draw, const Theme& theme, const RectPx& cell, const std::string& name,
                    const std::vector<std::string>& names = {});
void draw_cell_scale(ImDrawList& draw, const Theme& theme, const RectPx& cell, double mm_per_px);
/// Names of the cells, and how long a piece of them is.
void draw_study_captions(ImDrawList& draw, const Theme& theme, const ModelsState& state, const StudyCells& cells);

}  // namespace homolog
