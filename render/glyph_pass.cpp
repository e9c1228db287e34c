#include "render/glyph_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "render/line_pass.h"
#include "render/shaders.h"

namespace homolog {
namespace {

struct Instance {
  std::array<float, 3> centre_mm;
  Rgb colour;
  float radius_mm;
};

}  // namespace

Result<GlyphPass> GlyphPass::make() {
  auto program = gl::Program::make(shaders::glyph_vert(), shaders::glyph_frag(), shaders::light_glsl());
  if (!program) return fail(program.error());
  GlyphPass pass;
  pass.program_ = std::move(*program);
  pass.attributes_ = gl::VertexArray::make();
  pass.instances_ = gl::Buffer::make();
  glBindVertexArray(pass.attributes_.name());
  glBindBuffer(GL_ARRAY_BUFFER, pass.instances_.name());
  gl::attribute(0, 3, sizeof(Instance), offsetof(Instance, centre_mm), 1);
  gl::attribute(1, 3, sizeof(Instance), offsetof(Instance, colour), 1);
  gl::attribute(2, 1, sizeof(Instance), offsetof(Instance, radius_mm), 1);
  glBindVertexArray(0);
  return pass;
}

void GlyphPass::draw(const GlyphLayer& layer, const Projection& projection) {
  std::vector<GlyphLayer::Glyph> far_to_near = layer.glyphs;
  const auto height = [&](const GlyphLayer::Glyph& glyph) {
    return (projection.eye_from_mm * glm::vec4(to_glm(glyph.position), 1)).z;
  };
  std::stable_sort(far_to_near.begin(), far_to_near.end(),
                   [&](const auto& a, const auto& b) { return height(a) < height(b); });
  draw(far_to_near, projection, false);
}

void GlyphPass::draw_in_slice(const GlyphLayer& layer, const SliceView& view, const Projection& projection) {
  std::vector<GlyphLayer::Glyph> discs;
  for (GlyphLayer::Glyph glyph : layer.glyphs) {
    const double distance_mm = view.normal().dot(glyph.position - view.centre);
    const double radius_mm = glyph.radius_mm;
    if (std::abs(distance_mm) >= radius_mm) continue;
    glyph.radius_mm = static_cast<float>(std::sqrt(radius_mm * radius_mm - distance_mm * distance_mm));
    discs.push_back(glyph);
  }
  draw(discs, projection, true);
}

void GlyphPass::draw(std::span<const GlyphLayer::Glyph> glyphs, const Projection& projection, bool discs) {
  if (glyphs.empty()) return;
  std::vector<Instance> instances;
  instances.reserve(glyphs.size());
  for (const auto& glyph : glyphs) instances.push_back({to_floats(glyph.position), glyph.colour, glyph.radius_mm});
  program_.use();
  program_.set("eye_from_mm", projection.eye_from_mm);
  program_.set("clip_from_eye", projection.clip_from_eye);
  program_.set("size_px", projection.size_px);
  program_.set("disc", discs ? 1 : 0);
  gl::upload(instances_, GL_ARRAY_BUFFER, std::span<const Instance>(instances), GL_STREAM_DRAW);
  glBindVertexArray(attributes_.name());
  // The soft edge is blended after all insides and leaves no depth: what is drawn later is not kept off it.
  const auto count = static_cast<GLsizei>(instances.size());
  program_.set("edge", 0);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
  program_.set("edge", 1);
  glDepthMask(GL_FALSE);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
  glDepthMask(GL_TRUE);
}

}  // namespace homolog
