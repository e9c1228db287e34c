#pragma once

#include "render/gl.h"
#include "render/projection.h"
#include "render/scene.h"

namespace homolog {

/// Glyphs as spheres cast in the fragment shader: round at every size for two triangles each.
class GlyphPass {
 public:
  static Result<GlyphPass> make();
  /// Spheres in space.
  void draw(const GlyphLayer& layer, const Projection& projection);
  /// Discs where the spheres meet the plane.
  void draw_in_slice(const GlyphLayer& layer, const SliceView& view, const Projection& projection);

 private:
  void draw(std::span<const GlyphLayer::Glyph> glyphs, const Projection& projection, bool discs);

  gl::Program program_;
  gl::VertexArray attributes_;
  gl::Buffer instances_;
};

}  // namespace homolog
