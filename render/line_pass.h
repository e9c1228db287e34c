#pragma once

#include <array>
#include <span>

#include "render/gl.h"
#include "render/projection.h"

namespace homolog {

/// A line as the GPU takes it: ends in mm, colours not premultiplied, width in px before the content scale.
struct LineInstance {
  std::array<float, 3> from_mm, to_mm;
  std::array<float, 4> colour_from, colour_to;
  float width_px;
};

inline std::array<float, 3> to_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Lines with a width, round ends and soft edges as rectangles on the screen: glLineWidth above 1 is an error in
/// OpenGL core.
class LinePass {
 public:
  static Result<LinePass> make();
  /// Draws premultiplied colour under the blending and depth test that are set.
  void draw(std::span<const LineInstance> lines, const Projection& projection);

 private:
  gl::Program program_;
  gl::VertexArray attributes_;
  gl::Buffer instances_;
};

}  // namespace homolog
