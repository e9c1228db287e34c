#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/editor/state/models/gallery.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

/// Behind the shapes of the Models mode.
inline constexpr std::array<float, 4> gallery_ground{0.075f, 0.08f, 0.09f, 1};

/// The pictures of the Models mode, the gallery and the model's shape, drawn again only when what they show changed.
class GalleryPictures {
 public:
  /// Draws into framebuffers of its own; one of them stays bound. Another page is drawn quickly at first, without
  /// glyphs and soft edges, and finely by the frames after it, a few cells in each: so no frame takes long.
  void draw(const ModelsState& state, const ModelsLayout& layout, float scale, Renderer& renderer);
  /// Whether the next frame shows the gallery finer than the last.
  bool draws_on(const ModelsState& state) const { return state.made.model && shown_.moving && !state.gallery.turning; }
  /// Copies what was drawn into the framebuffer that is bound, whose height is given.
  void copy(const ModelsLayout& layout, int height_px) const;
  /// Draws shapes into the cells of a grid as the gallery shows its own, into the framebuffer that is bound, whose
  /// height is given. `room` is left in each cell, and has the ground's colour already.
  void draw_grid(const ModelsState& state, const GalleryGrid& grid, const CaptionRoom& room,
                 const std::vector<std::shared_ptr<const Points>>& shapes, int height_px, float scale,
                 Renderer& renderer, const std::array<float, 4>& ground);
  /// The renderer's refusal since the last call; empty where there is none.
  std::string take_error() { return std::exchange(error_, {}); }

 private:
  struct Drawn {
    std::unique_ptr<Framebuffer> still, moving;
    int width = 0, height = 0;
  };
  /// The content of the gallery's picture.
  struct GalleryKey {
    std::shared_ptr<const StudyModel> model;
    Camera3D camera;
    bool focused = false, glyphs = false, moving = false;
    Eigen::Index pinned = -1;
    double glyph_spacing_mm = 0;
    GalleryGrid grid;
    float scale = 0;
    bool operator==(const GalleryKey&) const = default;
  };
  struct ModelKey {
    GalleryKey view;
    std::vector<double> deviations;
    bool difference = false;
    std::array<std::string, 2> compared;
    bool operator==(const ModelKey&) const = default;
  };
  GalleryKey key_of(const ModelsState& state, const GalleryGrid& grid, bool moving, float scale) const;

  /// Colours and glyphs of the vertices, for the model and spacing that are shown.
  void prepare(const ModelsState& state);
  Scene scene_of(const ModelsState& state, std::shared_ptr<const Points> points, bool glyphs) const;
  /// The framebuffer for a picture of that size; null where it could not be made.
  Framebuffer* framebuffer_for(Drawn& drawn, const RectPx& rect, bool moving);
  void draw_gallery(const ModelsState& state, const RectPx& rect, float scale, Renderer& renderer);
  /// Draws cells from `first` on into the framebuffer for the key; false where there is none.
  bool draw_cells(const ModelsState& state, const GalleryKey& key, const RectPx& rect, std::size_t first,
                  std::size_t count, Renderer& renderer);
  void draw_model(const ModelsState& state, const RectPx& rect, float scale, Renderer& renderer);

  /// The shapes of the page, made anew when another one is shown.
  void take_page(const ModelsState& state, const GalleryGrid& grid);

  std::shared_ptr<const StudyModel> page_of_;
  std::size_t page_first_ = 0;
  std::vector<std::shared_ptr<const Points>> page_;
  std::shared_ptr<const StudyModel> prepared_for_;
  double prepared_spacing_mm_ = 0;
  std::shared_ptr<const std::vector<Rgb>> colours_;
  std::vector<std::int32_t> glyphs_;
  Drawn gallery_, model_;
  GalleryKey shown_, fine_;     ///< the gallery on the screen, and the one that is being drawn finely
  std::size_t fine_cells_ = 0;  ///< those of it that are drawn
  ModelKey model_key_;
  std::string error_;
};

/// The scale of a difference of groups: the largest, rounded up to a round number, mm.
double difference_scale_mm(const VertexScalars& difference_mm);
/// Blue inwards, light none, red outwards; `share` −1…1 of the scale.
Rgb difference_colour(double share);

}  // namespace homolog
