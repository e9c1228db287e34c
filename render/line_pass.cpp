#include "render/line_pass.h"

#include <cstddef>

#include "render/shaders.h"

namespace homolog {

Result<LinePass> LinePass::make() {
  auto program = gl::Program::make(shaders::line_vert(), shaders::line_frag());
  if (!program) return fail(program.error());
  LinePass pass;
  pass.program_ = std::move(*program);
  pass.attributes_ = gl::VertexArray::make();
  pass.instances_ = gl::Buffer::make();
  glBindVertexArray(pass.attributes_.name());
  glBindBuffer(GL_ARRAY_BUFFER, pass.instances_.name());
  constexpr std::size_t stride = sizeof(LineInstance);
  gl::attribute(0, 3, stride, offsetof(LineInstance, from_mm), 1);
  gl::attribute(1, 3, stride, offsetof(LineInstance, to_mm), 1);
  gl::attribute(2, 4, stride, offsetof(LineInstance, colour_from), 1);
  gl::attribute(3, 4, stride, offsetof(LineInstance, colour_to), 1);
  gl::attribute(4, 1, stride, offsetof(LineInstance, width_px), 1);
  glBindVertexArray(0);
  return pass;
}

void LinePass::draw(std::span<const LineInstance> lines, const Projection& projection) {
  if (lines.empty()) return;
  program_.use();
  program_.set("eye_from_mm", projection.eye_from_mm);
  program_.set("clip_from_eye", projection.clip_from_eye);
  program_.set("size_px", projection.size_px);
  program_.set("content_scale", projection.content_scale);
  gl::upload(instances_, GL_ARRAY_BUFFER, lines, GL_STREAM_DRAW);
  glBindVertexArray(attributes_.name());
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(lines.size()));
}

}  // namespace homolog
