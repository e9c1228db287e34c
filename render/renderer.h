#pragma once

#include <memory>

#include "core/base/result.h"
#include "render/faint_layer.h"
#include "render/scene.h"

namespace homolog {

/// The place to draw at: a rectangle of the framebuffer that is bound, in px from its lower left corner.
struct Viewport {
  int x = 0, y = 0, width = 0, height = 0;
  float content_scale = 1;  ///< multiplies line widths
};

/// Draws scenes with OpenGL 3.3 core. Needs a current context at construction, at every call and at destruction;
/// belongs to that context's thread. Colour in the framebuffer is premultiplied by alpha. Keeps textures and buffers
/// between calls and uploads only what changed.
class Renderer {
 public:
  /// Errors: a context older than OpenGL 3.3, or a driver that refuses a shader.
  static Result<std::unique_ptr<Renderer>> make();
  ~Renderer();

  /// Clears the target (where the scene has a background) and draws into it, nothing outside it. Slices need no
  /// multisampling, their edges are soft by themselves; the 3D view does. Errors, once a volume: it is larger than the
  /// GPU's 3-D texture limit or memory and is shown at reduced resolution, or not at all. The rest of the scene is
  /// drawn all the same.
  Result<void> draw(const Scene& scene, const SliceView& view, const Viewport& target);
  Result<void> draw(const Scene& scene, const Camera3D& view, const Viewport& target);
  /// Draws what is seen through of the scene's meshes into the layer, where its solid planes do not hide it.
  Result<void> draw_faint(const Scene& scene, const Camera3D& view, const FaintLayer& layer);
  /// Lays a layer as large as the target in, by depth, as what is seen through besides the scene's own meshes.
  Result<void> draw(const Scene& scene, const Camera3D& view, const Viewport& target, const FaintLayer& faint);

 private:
  Result<void> draw(const Scene& scene, const Camera3D& view, const Viewport& target, const FaintLayer* faint);
  struct Parts;
  explicit Renderer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// Projection used by draw, for picking: px from the target's upper left corner to mm and back.
Vec3 slice_point_mm(const SliceView& view, const Viewport& target, double x_px, double y_px);
Eigen::Vector2d slice_point_px(const SliceView& view, const Viewport& target, const Vec3& p_mm);
struct Ray {
  Vec3 from = Vec3::Zero(), direction = Vec3::UnitX();
};
Ray camera_ray(const Camera3D& camera, const Viewport& target, double x_px, double y_px);
/// px position of a point; z is its depth before the eye in mm (> 0 in front of it).
Vec3 camera_point_px(const Camera3D& camera, const Viewport& target, const Vec3& p_mm);

}  // namespace homolog
