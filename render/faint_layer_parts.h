#pragma once

#include "render/faint_layer.h"
#include "render/gl.h"

namespace homolog {

struct FaintLayer::Parts {
  int width_px = 0, height_px = 0;
  gl::Texture colour;  ///< premultiplied by alpha
  gl::Texture depth;   ///< depth of the nearest surface
  gl::FramebufferObject framebuffer;
};

}  // namespace homolog
