#pragma once

#include "render/gl.h"
#include "render/line_pass.h"
#include "render/scene.h"

namespace homolog {

/// Outlines of meshes in a slice. The short segments of one outline overlap at their ends; drawn into a layer of
/// their own by the maximum and laid over the picture as a whole, the soft edge and the opacity stay even along it.
class OutlinePass {
 public:
  static Result<OutlinePass> make();
  void draw(const MeshLayer& mesh, const SliceView& view, const Viewport& target, LinePass& lines);

 private:
  void make_layer(int width, int height);

  gl::Program program_;
  gl::VertexArray no_attributes_;
  gl::FramebufferObject framebuffer_;
  gl::Texture layer_;
  int layer_width_ = 0, layer_height_ = 0;
};

}  // namespace homolog
