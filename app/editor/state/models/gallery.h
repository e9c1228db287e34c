#pragma once

#include <algorithm>
#include <optional>

#include "app/editor/state/layout.h"
#include "app/editor/state/models/models_state.h"

namespace homolog {

/// The places of the parts of the Models mode.
struct ModelsLayout {
  RectPx cases, gallery_header, gallery, model_header, model, panel;
};
ModelsLayout models_layout(const Layout& layout);

/// Room that is kept free of shapes for what is written there, px.
struct CaptionRoom {
  float above = 0, below = 0;
  RectPx left_of(const RectPx& rect) const {
    return {rect.x, rect.y + above, rect.width, std::max(rect.height - above - below, 1.0f)};
  }
};
/// Returns the room in a picture's cell, at the scale of its letters [caption_scale]: above for its name, below for a
/// scale bar.
CaptionRoom caption_room(float scale);
/// Below the model's shape, for the legend of its colours.
CaptionRoom legend_room(const ModelsState& state, float scale);

/// Cells for shapes in an area, as near to square as can be, in reading order.
struct GalleryGrid {
  RectPx area;  ///< px of the window
  int columns = 1, rows = 1;
  std::size_t shapes = 0;
  std::size_t first = 0;  ///< the first of these shapes in the model

  /// By the shape's number in the model.
  RectPx cell(std::size_t shape) const;
  std::optional<std::size_t> shape_at(double x_px, double y_px) const;
  bool operator==(const GalleryGrid&) const = default;
};
GalleryGrid gallery_grid(std::size_t shapes, const RectPx& area);
/// Returns the grid of the page that is shown. Cells lie the same on all pages.
GalleryGrid page_grid(const ModelsState& state, const RectPx& area);

/// The linked camera in the cell of a shape: around the shapes' common centre, or around the pinned vertex.
Camera3D cell_camera(const ModelsState& state, const Points& shape);
/// px of the window.
Eigen::Vector2d cell_px(const Camera3D& camera, const RectPx& cell, const Vec3& p_mm);
/// Whether the surface at a vertex faces the viewer.
bool faces_viewer(const Camera3D& camera, const Mesh& shape, Eigen::Index vertex);
/// The vertex under the pointer: the nearest to the eye of those within reach.
std::optional<GalleryVertex> vertex_at(const ModelsState& state, const GalleryGrid& grid, double x_px, double y_px,
                                       float scale);

/// Moves what all cells look at along with the pointer; a cell is `side_px` wide or high, whichever is less.
void pan_gallery(ModelsState& state, double right_px, double down_px, double side_px);
void zoom_gallery(ModelsState& state, double steps);

}  // namespace homolog
