#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/editor/view_geometry.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

/// The pictures of the four views as textures, drawn again only when what they show changed.
class ViewPictures {
 public:
  static Result<ViewPictures> make();

  // Both bind a framebuffer of their own where they draw.
  /// The texture of a view. `scene` and the view's geometry decide whether it is drawn again. 0 where the driver has no
  /// room for it.
  unsigned int slice(ViewKind kind, const Scene& scene, const SliceView& view, const Target& target);
  unsigned int space(const Scene& scene, const Camera3D& camera, const Target& target);
  /// What the renderer refused since the last call; empty where nothing.
  std::string take_error() { return std::exchange(error_, {}); }
  Renderer& renderer() { return *renderer_; }

 private:
  struct Drawn {
    std::unique_ptr<Framebuffer> framebuffer;
    int width = 0, height = 0;
    Scene scene;
    SliceView slice;
    Camera3D camera;
    float content_scale = 0;
    unsigned int texture = 0;
  };
  explicit ViewPictures(std::unique_ptr<Renderer> renderer) : renderer_(std::move(renderer)) {}
  /// False where the framebuffer could not be made.
  bool fit(Drawn& drawn, const Target& target, int samples);

  std::unique_ptr<Renderer> renderer_;
  std::array<Drawn, 4> drawn_;
  std::string error_;
};

/// Whether two scenes give the same picture: the same shared parts, the same revisions, the same settings.
bool same_scene(const Scene& a, const Scene& b);

}  // namespace homolog
