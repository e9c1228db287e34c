#include "app/editor/drawing/view_pictures.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace homolog {

Result<ViewPictures> ViewPictures::make() {
  auto renderer = Renderer::make();
  if (!renderer) return fail(renderer.error());
  return ViewPictures(std::move(*renderer));
}

bool ViewPictures::make_room(Drawn& drawn, const Viewport& target, int samples) {
  if (drawn.framebuffer && drawn.width == target.width && drawn.height == target.height) return true;
  drawn = {};
  auto framebuffer = Framebuffer::make(target.width, target.height, samples);
  if (!framebuffer) {
    error_ = framebuffer.error().sentence();
    return false;
  }
  drawn.framebuffer = std::move(*framebuffer);
  drawn.width = target.width;
  drawn.height = target.height;
  return true;
}

bool ViewPictures::draw_slice(Drawn& drawn, const Scene& scene, const SliceView& view, const Viewport& target,
                              const Framebuffer* below) {
  const bool current = drawn.content_scale == target.content_scale && drawn.slice == view && drawn.scene == scene;
  if (current) return false;
  drawn.framebuffer->bind();
  if (below != nullptr) below->copy_to(0, 0);
  if (auto done = renderer_->draw(scene, view, target); !done) error_ = done.error().sentence();
  drawn.scene = scene;
  drawn.slice = view;
  drawn.content_scale = target.content_scale;
  return true;
}

void ViewPictures::forget() {
  slices_ = {};
  still_space_ = {};
  moving_space_ = {};
  faint_ = {};
}

const Framebuffer* ViewPictures::slice(ViewKind kind, const Scene& scene, const SliceView& view,
                                       const Viewport& target) {
  DrawnSlice& drawn = slices_[index_of(kind)];
  if (!make_room(drawn.below, target, 1) || !make_room(drawn.whole, target, 1)) return nullptr;
  // What stays while a mesh is dragged lies below: the image, and all meshes but the last, which is the active one.
  Scene below, over = scene;
  below.image = std::exchange(over.image, {});
  below.labels = std::exchange(over.labels, {});
  below.background = std::exchange(over.background, std::nullopt);
  if (over.meshes.size() > 1) {
    const auto active = over.meshes.end() - 1;
    below.meshes.assign(std::make_move_iterator(over.meshes.begin()), std::make_move_iterator(active));
    over.meshes.erase(over.meshes.begin(), active);
  }
  if (draw_slice(drawn.below, below, view, target, nullptr)) drawn.whole.content_scale = 0;
  draw_slice(drawn.whole, over, view, target, drawn.below.framebuffer.get());
  return drawn.whole.framebuffer.get();
}

const FaintLayer* ViewPictures::faint_of(const Scene& scene, const Camera3D& camera, const Viewport& target) {
  const bool as_large =
      faint_.layer && faint_.layer->width_px() == target.width && faint_.layer->height_px() == target.height;
  if (!as_large) {
    faint_ = {};
    auto layer = FaintLayer::make(target.width, target.height);
    if (!layer) {
      error_ = layer.error().sentence();
      return nullptr;
    }
    faint_.layer = std::move(*layer);
  } else if (faint_.camera == camera && faint_.scene == scene) {
    return &*faint_.layer;
  }
  if (auto done = renderer_->draw_faint(scene, camera, *faint_.layer); !done) error_ = done.error().sentence();
  faint_.scene = scene;
  faint_.camera = camera;
  return &*faint_.layer;
}

const Framebuffer* ViewPictures::space(const Scene& scene, const Camera3D& camera, const Viewport& target,
                                       bool moving) {
  Drawn& drawn = moving ? moving_space_ : still_space_;
  if (!make_room(drawn, target, moving ? 1 : 4)) return nullptr;
  const bool current = drawn.content_scale == target.content_scale && drawn.camera == camera && drawn.scene == scene;
  if (current) return drawn.framebuffer.get();
  // Dozens of meshes that are seen through take most of the time, and stay while one is dragged.
  const auto is_faint = [](const MeshLayer& mesh) { return mesh.surface_opacity < 1; };
  const FaintLayer* layer = nullptr;
  Scene over;
  if (moving && std::ranges::any_of(scene.meshes, is_faint)) {
    Scene faint;
    over = scene;
    const auto first = std::stable_partition(over.meshes.begin(), over.meshes.end(), std::not_fn(is_faint));
    faint.meshes.assign(first, over.meshes.end());
    over.meshes.erase(first, over.meshes.end());
    faint.image = scene.image;
    faint.planes = scene.planes;
    layer = faint_of(faint, camera, target);
  }
  drawn.framebuffer->bind();
  auto done = layer != nullptr ? renderer_->draw(over, camera, target, *layer) : renderer_->draw(scene, camera, target);
  if (!done) error_ = done.error().sentence();
  drawn.scene = scene;
  drawn.camera = camera;
  drawn.content_scale = target.content_scale;
  return drawn.framebuffer.get();
}

}  // namespace homolog
