#include "render/outline_pass.h"

#include <algorithm>

#include "render/outlines.h"
#include "render/shaders.h"

namespace homolog {
namespace {

/// The same hue and value at full saturation; greys stay as they are.
Rgb saturated(const Rgb& colour) {
  const auto [lowest, highest] = std::minmax({colour[0], colour[1], colour[2]});
  if (highest - lowest < 0.02f) return colour;
  Rgb out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = highest * (colour[k] - lowest) / (highest - lowest);
  return out;
}

std::array<float, 4> colour_at(const EdgeCrossing& crossing, const MeshLayer& mesh) {
  const Rgb& low = mesh.colours ? (*mesh.colours)[crossing.low] : mesh_colour;
  const Rgb& high = mesh.colours ? (*mesh.colours)[crossing.high] : mesh_colour;
  const auto share = static_cast<float>(crossing.share);
  Rgb between;
  for (std::size_t k = 0; k < 3; ++k) between[k] = low[k] + share * (high[k] - low[k]);
  const Rgb shown = mesh.saturated_outline ? saturated(between) : between;
  return {shown[0], shown[1], shown[2], 1};
}

std::vector<LineInstance> outline_lines(const MeshLayer& mesh, const SliceView& view) {
  std::vector<LineInstance> lines;
  Outlines once;
  Outlines& outlines = mesh.outlines ? *mesh.outlines : once;
  for (const OutlineSegment& segment : *outlines.of(mesh.topology, mesh.points, view.centre, view.normal())) {
    lines.push_back({to_floats(segment.from.point), to_floats(segment.to.point), colour_at(segment.from, mesh),
                     colour_at(segment.to, mesh), mesh.outline_px});
  }
  return lines;
}

/// The part of the target that an outline can touch, in px from the target's lower left corner.
Eigen::AlignedBox2i reach_of(const std::vector<LineInstance>& outline, const MeshLayer& mesh, const SliceView& view,
                             const Viewport& target) {
  Eigen::AlignedBox2d reach;
  for (const LineInstance& line : outline) {
    for (const auto& end : {line.from_mm, line.to_mm}) {
      const Eigen::Vector2d px = slice_point_px(view, target, Vec3(end[0], end[1], end[2]));
      reach.extend(Eigen::Vector2d(px.x(), target.height - px.y()));
    }
  }
  const double margin_px = mesh.outline_px * target.content_scale / 2 + 2;
  const Eigen::Vector2d size(target.width, target.height), margin(margin_px, margin_px);
  return {(reach.min() - margin).cwiseMax(0).cwiseMin(size).cast<int>(),
          (reach.max() + margin).cwiseMax(0).cwiseMin(size).cast<int>()};
}

}  // namespace

Result<OutlinePass> OutlinePass::make() {
  auto program = gl::Program::make(shaders::layer_vert(), shaders::layer_frag());
  if (!program) return fail(program.error());
  OutlinePass pass;
  pass.program_ = std::move(*program);
  pass.no_attributes_ = gl::VertexArray::make();
  pass.framebuffer_ = gl::FramebufferObject::make();
  pass.layer_ = gl::Texture::make();
  return pass;
}

void OutlinePass::make_layer(int width, int height) {
  if (width <= layer_width_ && height <= layer_height_) return;
  layer_width_ = std::max(width, layer_width_);
  layer_height_ = std::max(height, layer_height_);
  glBindTexture(GL_TEXTURE_2D, layer_.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, layer_width_, layer_height_, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, layer_.name(), 0);
}

void OutlinePass::draw(const MeshLayer& mesh, const SliceView& view, const Viewport& target, LinePass& lines) {
  if (!mesh.topology || !mesh.points || !mesh.outline || mesh.outline_opacity <= 0) return;
  const std::vector<LineInstance> outline = outline_lines(mesh, view);
  if (outline.empty()) return;
  const Eigen::AlignedBox2i reach = reach_of(outline, mesh, view, target);

  GLint picture = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &picture);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
  make_layer(target.width, target.height);
  glViewport(0, 0, target.width, target.height);
  glScissor(reach.min().x(), reach.min().y(), reach.sizes().x(), reach.sizes().y());
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  glBlendEquation(GL_MAX);
  lines.draw(outline, projection_of(view, target));
  glBlendEquation(GL_FUNC_ADD);

  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(picture));
  glViewport(target.x, target.y, target.width, target.height);
  glScissor(target.x + reach.min().x(), target.y + reach.min().y(), reach.sizes().x(), reach.sizes().y());
  program_.use();
  program_.set("layer", 0);
  program_.set("origin_px", glm::vec2(target.x, target.y));
  program_.set("opacity", mesh.outline_opacity);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, layer_.name());
  glBindVertexArray(no_attributes_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glScissor(target.x, target.y, target.width, target.height);
}

}  // namespace homolog
