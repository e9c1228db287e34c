#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/editor/state/view_geometry.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

/// The pictures of the four views, drawn again only when what they show changed. The parts that a drag does not change
/// (the image of a slice) are kept apart, because rendering in software samples a volume slowly.
class ViewPictures {
 public:
  static Result<ViewPictures> make();

  // Both bind a framebuffer of their own where they draw.
  /// `scene` and the view's geometry decide whether a view is drawn again. Null where the driver has no room for it.
  const Framebuffer* slice(ViewKind kind, const Scene& scene, const SliceView& view, const Viewport& target);
  /// `moving` draws with one sample a pixel, and what is seen through as one surface (FaintLayer).
  const Framebuffer* space(const Scene& scene, const Camera3D& camera, const Viewport& target, bool moving);
  /// Lets go of everything that was drawn, and of the volume in it.
  void forget();
  /// The renderer's refusal since the last call; empty where there is none.
  std::string take_error() { return std::exchange(error_, {}); }
  Renderer& renderer() { return *renderer_; }

 private:
  /// A picture, and what it shows.
  struct Drawn {
    std::unique_ptr<Framebuffer> framebuffer;
    int width = 0, height = 0;
    Scene scene;
    SliceView slice;
    Camera3D camera;
    float content_scale = 0;
  };
  struct DrawnSlice {
    Drawn below, whole;  ///< below: what stays while a mesh is dragged
  };
  /// The meshes that are seen through, and what the layer shows.
  struct DrawnFaint {
    std::optional<FaintLayer> layer;
    Scene scene;
    Camera3D camera;
  };
  explicit ViewPictures(std::unique_ptr<Renderer> renderer) : renderer_(std::move(renderer)) {}
  /// Makes the framebuffer of that size, where it is not there. False where it could not be made.
  bool make_room(Drawn& drawn, const Viewport& target, int samples);
  /// Draws `scene` where `drawn` shows another one, over `below` where given. True where it did.
  bool draw_slice(Drawn& drawn, const Scene& scene, const SliceView& view, const Viewport& target,
                  const Framebuffer* below);
  /// Null where the driver has no room for it.
  const FaintLayer* faint_of(const Scene& scene, const Camera3D& camera, const Viewport& target);

  std::unique_ptr<Renderer> renderer_;
  std::array<DrawnSlice, 3> slices_;
  Drawn still_space_, moving_space_;
  DrawnFaint faint_;
  std::string error_;
};

}  // namespace homolog
