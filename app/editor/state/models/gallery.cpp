#include "app/editor/state/models/gallery.h"

#include <algorithm>
#include <cmath>

#include "core/base/pictures/caption_sizes.h"
#include "core/base/pictures/cell_grid.h"
#include "render/hued_shapes.h"
#include "render/renderer.h"

namespace homolog {

namespace {

// Layout units, on a grid of 4.
constexpr float cases_width = 320, tools_height = 36, model_height = 232;

/// A cell from its own corner, as the renderer's projection takes it.
Viewport target_of(const RectPx& cell) {
  return {0, 0, static_cast<int>(cell.width), static_cast<int>(cell.height), 1};
}

}  // namespace

ModelsLayout models_layout(const Layout& layout) {
  const auto px = [&](float units) { return std::round(units * layout.scale); };
  const RectPx& body = layout.models;
  ModelsLayout parts;
  const float left = std::min(px(cases_width), body.width / 3),
              right = std::min(px(layout_units::panel_width), body.width / 3);
  const float middle_x = body.x + left + px(layout_units::gap), right_x = body.x + body.width - right;
  const float middle = std::max(right_x - px(layout_units::gap) - middle_x, 0.0f);
  parts.cases = {body.x, body.y, left, body.height};
  parts.gallery_header = {middle_x, body.y, middle, px(layout_units::header_height) + px(tools_height)};
  parts.gallery = {middle_x, body.y + parts.gallery_header.height, middle,
                   std::max(body.height - parts.gallery_header.height, 0.0f)};
  parts.model_header = {right_x, body.y, right, px(layout_units::header_height)};
  parts.model = {right_x, body.y + px(layout_units::header_height), right, std::min(px(model_height), body.height / 2)};
  const float below = parts.model.y + parts.model.height;
  parts.panel = {right_x, below, right, std::max(body.y + body.height - below, 0.0f)};
  return parts;
}

CaptionRoom caption_room(float scale) {
  return {std::round(room_of_name * letters_px * scale), std::round(room_of_bar * letters_px * scale)};
}

CaptionRoom legend_room(const ModelsState& state, float scale) {
  constexpr float legend = 36;
  return {0, state.view.show_difference ? std::round(legend * scale) : 0};
}

GalleryGrid gallery_grid(std::size_t shapes, const RectPx& area) {
  const auto count = static_cast<int>(std::max<std::size_t>(shapes, 1));
  const int columns = columns_of_grid(count, area.width, area.height);
  return {area, columns, rows_of_grid(count, columns), shapes};
}

GalleryGrid page_grid(const ModelsState& state, const RectPx& area) {
  const std::size_t count = state.made.model->names.size();
  GalleryGrid grid = gallery_grid(std::min(count, shapes_a_page), area);
  grid.first = std::min(state.gallery.page, gallery_pages(state) - 1) * shapes_a_page;
  grid.shapes = std::min(count - grid.first, shapes_a_page);
  return grid;
}

RectPx GalleryGrid::cell(std::size_t shape) const {
  const int number = static_cast<int>(shape - first), column = number % columns, row = number / columns;
  const auto edge = [](float from, float size, int k, int parts) {
    return std::round(from + size * static_cast<float>(k) / static_cast<float>(parts));
  };
  const float x0 = edge(area.x, area.width, column, columns), x1 = edge(area.x, area.width, column + 1, columns);
  const float y0 = edge(area.y, area.height, row, rows), y1 = edge(area.y, area.height, row + 1, rows);
  return {x0 + 1, y0 + 1, std::max(x1 - x0 - 2, 0.0f), std::max(y1 - y0 - 2, 0.0f)};
}

std::optional<std::size_t> GalleryGrid::shape_at(double x_px, double y_px) const {
  for (std::size_t k = first; k < first + shapes; ++k)
    if (cell(k).contains(x_px, y_px)) return k;
  return std::nullopt;
}

Camera3D cell_camera(const ModelsState& state, const Points& shape) {
  Camera3D camera = state.gallery.camera;
  camera.target += state.gallery.focused && state.gallery.pinned ? Vec3(shape.row(*state.gallery.pinned))
                                                                 : state.made.model->centre_mm;
  return camera;
}

Eigen::Vector2d cell_px(const Camera3D& camera, const RectPx& cell, const Vec3& p_mm) {
  const Vec3 px = camera_point_px(camera, target_of(cell), p_mm);
  return {px.x() + cell.x, px.y() + cell.y};
}

bool faces_viewer(const Camera3D& camera, const Mesh& shape, Eigen::Index vertex) {
  if (!shape.topology) return true;
  Vec3 normal = Vec3::Zero();
  for (const std::int32_t face : shape.topology->faces_of(vertex)) {
    const auto t = shape.topology->triangles().row(face);
    const Vec3 a = shape.points.row(t[0]), b = shape.points.row(t[1]), c = shape.points.row(t[2]);
    normal += (b - a).cross(c - a);
  }
  return normal.dot(camera.to_eye) > 0;
}

std::optional<GalleryVertex> vertex_at(const ModelsState& state, const GalleryGrid& grid, double x_px, double y_px,
                                       float scale) {
  const auto shape = grid.shape_at(x_px, y_px);
  if (!state.made.model || !shape) return std::nullopt;
  const Points points = state.made.model->shape(*shape);
  const RectPx cell = grid.cell(*shape);
  const Camera3D camera = cell_camera(state, points);
  const double reach_px = 6 * static_cast<double>(scale);
  std::optional<GalleryVertex> found;
  double nearest_mm = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Vec3 px = camera_point_px(camera, target_of(cell), points.row(i));
    if (std::hypot(px.x() + cell.x - x_px, px.y() + cell.y - y_px) > reach_px) continue;
    if (found && px.z() >= nearest_mm) continue;
    found = GalleryVertex{*shape, i};
    nearest_mm = px.z();
  }
  return found;
}

void pan_gallery(ModelsState& state, double right_px, double down_px, double side_px) {
  const double mm_per_px = 2 * shown_radius_mm(state.gallery.camera) / side_px;
  state.gallery.camera.target +=
      mm_per_px * (down_px * state.gallery.camera.up - right_px * camera_right(state.gallery.camera));
}

void zoom_gallery(ModelsState& state, double steps) {
  if (!state.made.model) return;
  // Nearer, the camera would cut off what is before its target.
  const double nearest_mm = 1.1 * state.made.model->radius_mm, farthest_mm = 20 * state.made.model->radius_mm;
  state.gallery.camera.distance_mm =
      std::clamp(state.gallery.camera.distance_mm * std::pow(1.12, -steps), nearest_mm, farthest_mm);
}

}  // namespace homolog
