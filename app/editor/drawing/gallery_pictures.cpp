#include "app/editor/drawing/gallery_pictures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/hued_shapes.h"

namespace homolog {

namespace {

constexpr std::size_t fine_cells_a_frame = 4;

}  // namespace

double difference_scale_mm(const VertexScalars& difference_mm) {
  const double largest = difference_mm.cwiseAbs().maxCoeff();
  if (largest <= 0) return 1;
  const double decade = std::pow(10, std::floor(std::log10(largest)));
  for (const double step : {1.0, 2.0, 5.0})
    if (largest <= step * decade) return step * decade;
  return 10 * decade;
}

Rgb difference_colour(double share) {
  const auto t = static_cast<float>(std::clamp(share, -1.0, 1.0));
  constexpr Rgb inwards{0.16f, 0.38f, 0.86f}, none{0.93f, 0.93f, 0.93f}, outwards{0.84f, 0.20f, 0.16f};
  const Rgb& end = t < 0 ? inwards : outwards;
  const float part = std::abs(t);
  return {none[0] + part * (end[0] - none[0]), none[1] + part * (end[1] - none[1]),
          none[2] + part * (end[2] - none[2])};
}

GalleryPictures::GalleryKey GalleryPictures::key_of(const ModelsState& state, const GalleryGrid& grid, bool moving,
                                                    float scale) const {
  return {.model = state.made.model,
          .camera = state.gallery.camera,
          .focused = state.gallery.focused,
          .glyphs = state.gallery.glyphs,
          .moving = moving,
          .pinned = state.gallery.focused ? *state.gallery.pinned : -1,
          .glyph_spacing_mm = state.gallery.glyph_spacing_mm,
          .grid = grid,
          .scale = scale};
}

void GalleryPictures::prepare(const ModelsState& state) {
  const StudyModel& model = *state.made.model;
  if (prepared_for_ != state.made.model) colours_ = hued_surface(*model.hues);
  if (prepared_for_ == state.made.model && prepared_spacing_mm_ == state.gallery.glyph_spacing_mm) return;
  prepared_for_ = state.made.model;
  prepared_spacing_mm_ = state.gallery.glyph_spacing_mm;
  glyphs_.clear();
  if (model.topology) {
    glyphs_ = glyph_vertices(model.mean, state.gallery.glyph_spacing_mm);
  } else {
    for (Eigen::Index i = 0; i < model.vertices(); ++i) glyphs_.push_back(static_cast<std::int32_t>(i));
  }
}

Scene GalleryPictures::scene_of(const ModelsState& state, std::shared_ptr<const Points> points, bool glyphs) const {
  const StudyModel& model = *state.made.model;
  Scene scene;
  scene.background = gallery_ground;
  // Points alone have nothing but their glyphs.
  const double radius_mm = model.topology ? 0.12 * state.gallery.glyph_spacing_mm : 0.012 * model.radius_mm;
  if (glyphs || !model.topology) add_hued_glyphs(scene.glyphs, *points, glyphs_, *model.hues, radius_mm);
  if (!model.topology) return scene;
  MeshLayer layer;
  layer.topology = model.topology;
  layer.points = std::move(points);
  layer.colours = colours_;
  layer.outline = false;
  scene.meshes.push_back(std::move(layer));
  return scene;
}

Framebuffer* GalleryPictures::framebuffer_for(Drawn& drawn, const RectPx& rect, bool moving) {
  const auto width = static_cast<int>(rect.width), height = static_cast<int>(rect.height);
  if (drawn.width != width || drawn.height != height) drawn = {nullptr, nullptr, width, height};
  auto& framebuffer = moving ? drawn.moving : drawn.still;
  if (!framebuffer) {
    auto made = Framebuffer::make(width, height, moving ? 1 : 4);
    if (!made) {
      error_ = made.error().sentence();
      return nullptr;
    }
    framebuffer = std::move(*made);
  }
  return framebuffer.get();
}

void GalleryPictures::take_page(const ModelsState& state, const GalleryGrid& grid) {
  if (page_of_ == state.made.model && page_first_ == grid.first && page_.size() == grid.shapes) return;
  page_of_ = state.made.model;
  page_first_ = grid.first;
  page_.clear();
  for (std::size_t k = grid.first; k < grid.first + grid.shapes; ++k)
    page_.push_back(std::make_shared<const Points>(state.made.model->shape(k)));
}

void GalleryPictures::draw_gallery(const ModelsState& state, const RectPx& rect, float scale, Renderer& renderer) {
  const GalleryGrid grid = page_grid(state, {0, 0, rect.width, rect.height});
  const GalleryKey key = key_of(state, grid, state.gallery.turning, scale);
  GalleryKey quick = key;
  quick.moving = true;
  const bool fits = gallery_.width == static_cast<int>(rect.width) && gallery_.height == static_cast<int>(rect.height);
  if (fits && key == shown_) return;
  if (!fits) fine_ = {};  // its picture is gone
  take_page(state, grid);
  const auto cells = static_cast<std::size_t>(grid.columns * grid.rows);
  if (!fits || quick != shown_) {
    const bool other_page = shown_.model != key.model || shown_.grid.first != key.grid.first;
    const GalleryKey& now = key.moving || other_page ? quick : key;
    if (draw_cells(state, now, rect, 0, cells, renderer)) shown_ = now;
    return;
  }
  if (key != fine_) {
    fine_ = key;
    fine_cells_ = 0;
  }
  const std::size_t count = std::min(fine_cells_a_frame, cells - fine_cells_);
  if (!draw_cells(state, key, rect, fine_cells_, count, renderer)) return;
  fine_cells_ += count;
  if (fine_cells_ < cells) return;
  shown_ = std::exchange(fine_, {});
}

bool GalleryPictures::draw_cells(const ModelsState& state, const GalleryKey& key, const RectPx& rect, std::size_t first,
                                 std::size_t count, Renderer& renderer) {
  Framebuffer* framebuffer = framebuffer_for(gallery_, rect, key.moving);
  if (framebuffer == nullptr) return false;
  framebuffer->bind();
  if (first == 0) {
    // Lines between the cells, where another grid left its own.
    Scene lines;
    lines.background = std::array<float, 4>{0, 0, 0, 0};
    const Viewport whole{0, 0, static_cast<int>(rect.width), static_cast<int>(rect.height), key.scale};
    if (auto drawn = renderer.draw(lines, state.gallery.camera, whole); !drawn) error_ = drawn.error().sentence();
  }
  for (std::size_t k = first; k < first + count; ++k) {
    const RectPx cell = key.grid.cell(key.grid.first + k);
    const Viewport target{static_cast<int>(cell.x), static_cast<int>(rect.height - cell.y - cell.height),
                          static_cast<int>(cell.width), static_cast<int>(cell.height), key.scale};
    const auto points = k < page_.size() ? page_[k] : nullptr;
    Scene empty;
    empty.background = gallery_ground;
    const auto drawn = renderer.draw(points ? scene_of(state, points, state.gallery.glyphs && !key.moving) : empty,
                                     points ? cell_camera(state, *points) : state.gallery.camera, target);
    if (!drawn) error_ = drawn.error().sentence();
  }
  return true;
}

void GalleryPictures::draw_grid(const ModelsState& state, const GalleryGrid& grid, const CaptionRoom& room,
                                const std::vector<std::shared_ptr<const Points>>& shapes, int height_px, float scale,
                                Renderer& renderer, const std::array<float, 4>& ground) {
  prepare(state);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const RectPx cell = room.left_of(grid.cell(k));
    const Viewport target{static_cast<int>(cell.x), height_px - static_cast<int>(cell.y + cell.height),
                          static_cast<int>(cell.width), static_cast<int>(cell.height), scale};
    Scene scene = scene_of(state, shapes[k], state.gallery.glyphs);
    scene.background = ground;
    const auto drawn = renderer.draw(scene, cell_camera(state, *shapes[k]), target);
    if (!drawn) error_ = drawn.error().sentence();
  }
}

void GalleryPictures::draw_model(const ModelsState& state, const RectPx& rect, float scale, Renderer& renderer) {
  const bool moving = state.gallery.turning || state.view.animated_mode;
  ModelKey key{key_of(state, {}, moving, scale), state.view.deviations, state.view.show_difference,
               state.view.compared};
  const bool fits = model_.width == static_cast<int>(rect.width) && model_.height == static_cast<int>(rect.height);
  if (fits && key == model_key_) return;
  Framebuffer* framebuffer = framebuffer_for(model_, rect, moving);
  if (framebuffer == nullptr) return;
  const StudyModel& model = *state.made.model;
  const auto points = std::make_shared<const Points>(
      state.view.show_difference ? model.mean.points : shape_of(model.model, shown_coefficients(state)));
  Scene scene = scene_of(state, points, state.gallery.glyphs && !moving && !state.view.show_difference);
  if (state.view.show_difference && model.topology) {
    const VertexScalars difference_mm = difference_of_groups_mm(model, state.view.compared[0], state.view.compared[1]);
    const double most_mm = difference_scale_mm(difference_mm);
    std::vector<Rgb> colours;
    for (const double value : difference_mm) colours.push_back(difference_colour(value / most_mm));
    scene.meshes.front().colours = std::make_shared<const std::vector<Rgb>>(std::move(colours));
  }
  framebuffer->bind();
  const int legend = static_cast<int>(legend_room(state, scale).below);
  Viewport target{0, 0, static_cast<int>(rect.width), static_cast<int>(rect.height), scale};
  Scene ground;
  ground.background = scene.background;
  if (legend > 0)
    if (auto drawn = renderer.draw(ground, Camera3D(), target); !drawn) error_ = drawn.error().sentence();
  target.y = legend;
  target.height = std::max(target.height - legend, 1);
  if (auto drawn = renderer.draw(scene, cell_camera(state, *points), target); !drawn) error_ = drawn.error().sentence();
  model_key_ = std::move(key);
}

void GalleryPictures::draw(const ModelsState& state, const ModelsLayout& layout, float scale, Renderer& renderer) {
  if (!state.made.model) {
    gallery_ = {};
    model_ = {};
    shown_ = fine_ = {};
    page_.clear();
    page_of_.reset();
    return;
  }
  prepare(state);
  if (layout.gallery.width >= 1 && layout.gallery.height >= 1) draw_gallery(state, layout.gallery, scale, renderer);
  if (layout.model.width >= 1 && layout.model.height >= 1) draw_model(state, layout.model, scale, renderer);
}

void GalleryPictures::copy(const ModelsLayout& layout, int height_px) const {
  const auto copy_one = [&](const Drawn& drawn, bool moving, const RectPx& rect) {
    const Framebuffer* shown = (moving ? drawn.moving : drawn.still).get();
    if (shown != nullptr) shown->copy_to(static_cast<int>(rect.x), height_px - static_cast<int>(rect.y + rect.height));
  };
  copy_one(gallery_, shown_.moving, layout.gallery);
  copy_one(model_, model_key_.view.moving, layout.model);
}

}  // namespace homolog
