#include "render/renderer.h"

#include <algorithm>
#include <cmath>

#include "render/faint_layer_parts.h"
#include "render/gl.h"
#include "render/glyph_pass.h"
#include "render/line_pass.h"
#include "render/mesh_pass.h"
#include "render/outline_pass.h"
#include "render/projection.h"
#include "render/shaders.h"
#include "render/slice_pass.h"

namespace homolog {
namespace {

/// Confines drawing to a target, clears it and sets premultiplied blending; gives OpenGL back as a new context has it
/// (but for the viewport, which is as before), since the window's own drawing shares the context.
class Drawing {
 public:
  Drawing(const Viewport& target, const std::optional<std::array<float, 4>>& background) {
    glGetIntegerv(GL_VIEWPORT, viewport_before_.data());
    glViewport(target.x, target.y, target.width, target.height);
    glScissor(target.x, target.y, target.width, target.height);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    if (!background) return;
    const auto& [red, green, blue, alpha] = *background;
    glClearColor(red * alpha, green * alpha, blue * alpha, alpha);
    glClear(GL_COLOR_BUFFER_BIT);
  }
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;
  ~Drawing() {
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glBindVertexArray(0);
    glUseProgram(0);
    for (const GLenum unit : {GL_TEXTURE2, GL_TEXTURE1, GL_TEXTURE0}) {
      glActiveTexture(unit);
      glBindTexture(GL_TEXTURE_2D, 0);
      glBindTexture(GL_TEXTURE_3D, 0);
    }
    glViewport(viewport_before_[0], viewport_before_[1], viewport_before_[2], viewport_before_[3]);
  }

 private:
  std::array<GLint, 4> viewport_before_{};
};

LineInstance instance_of(const LineLayer::Line& line) {
  return {to_floats(line.from), to_floats(line.to), line.colour, line.colour, line.width_px};
}

std::vector<LineInstance> lines_in_slice(const LineLayer& layer, const SliceView& view) {
  const double tolerance_mm = view.mm_per_px / 2;
  const auto in_plane = [&](const Vec3& p_mm) {
    return std::abs(view.normal().dot(p_mm - view.centre)) <= tolerance_mm;
  };
  std::vector<LineInstance> lines;
  for (const LineLayer::Line& line : layer.lines) {
    if (in_plane(line.from) && in_plane(line.to)) lines.push_back(instance_of(line));
  }
  return lines;
}

void add_frame(const PlaneInSpace& part, std::vector<LineInstance>& lines) {
  constexpr float frame_px = 2;
  const Vec3 right = part.half_width_mm * part.plane.right, down = part.half_height_mm * part.plane.down;
  const std::array<Vec3, 4> corners{Vec3(part.plane.centre - right - down), Vec3(part.plane.centre + right - down),
                                    Vec3(part.plane.centre + right + down), Vec3(part.plane.centre - right + down)};
  const auto& rgb = part.frame_colour;
  for (std::size_t i = 0; i < 4; ++i) {
    lines.push_back(instance_of({corners[i], corners[(i + 1) % 4], {rgb[0], rgb[1], rgb[2], 1}, frame_px}));
  }
}

bool is_solid(const PlaneInSpace& part) {
  return !part.behind_meshes && part.opacity >= 1;
}

}  // namespace

struct Renderer::Parts {
  SlicePass slice;
  OutlinePass outline;
  LinePass lines;
  MeshPass meshes;
  GlyphPass glyphs;
  gl::Program faint;
  gl::VertexArray no_attributes;

  template <class Wanted>
  void draw_planes(const Scene& scene, const Projection& projection, const Wanted& wanted) {
    std::vector<LineInstance> frames;
    for (const PlaneInSpace& part : scene.planes) {
      if (!wanted(part)) continue;
      slice.draw(scene, part, projection);
      add_frame(part, frames);
    }
    lines.draw(frames, projection);
  }
  void lay_in(const gl::Texture& colour, const gl::Texture& depth, const Viewport& target) const;
  Result<void> report() {
    if (auto complaint = slice.take_complaint()) return fail("", *complaint);
    return {};
  }
};

void Renderer::Parts::lay_in(const gl::Texture& colour, const gl::Texture& depth, const Viewport& target) const {
  faint.use();
  faint.set("layer", 0);
  faint.set("layer_depth", 1);
  faint.set("origin_px", glm::vec2(target.x, target.y));
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, depth.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, colour.name());
  glBindVertexArray(no_attributes.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

Renderer::Renderer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::make() {
  if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 33) {
    return fail("", "the graphics driver offers OpenGL " + std::to_string(epoxy_gl_version() / 10) + "." +
                        std::to_string(epoxy_gl_version() % 10) +
                        " and 3.3 is needed; update it, or set LIBGL_ALWAYS_SOFTWARE=1 for software rendering");
  }
  auto slice = SlicePass::make();
  if (!slice) return fail(slice.error());
  auto outline = OutlinePass::make();
  if (!outline) return fail(outline.error());
  auto lines = LinePass::make();
  if (!lines) return fail(lines.error());
  auto meshes = MeshPass::make();
  if (!meshes) return fail(meshes.error());
  auto glyphs = GlyphPass::make();
  if (!glyphs) return fail(glyphs.error());
  auto faint = gl::Program::make(shaders::layer_vert(), shaders::faint_frag());
  if (!faint) return fail(faint.error());
  return std::unique_ptr<Renderer>(new Renderer(
      std::make_unique<Parts>(Parts{std::move(*slice), std::move(*outline), std::move(*lines), std::move(*meshes),
                                    std::move(*glyphs), std::move(*faint), gl::VertexArray::make()})));
}

Result<void> Renderer::draw(const Scene& scene, const SliceView& view, const Viewport& target) {
  if (target.width <= 0 || target.height <= 0) return {};
  const Drawing drawing(target, scene.background);
  const Projection projection = projection_of(view, target);
  const PlaneInSpace whole_view{view, target.width * view.mm_per_px / 2, target.height * view.mm_per_px / 2, {}};
  parts_->slice.draw(scene, whole_view, projection);
  for (const MeshLayer& mesh : scene.meshes) parts_->outline.draw(mesh, view, target, parts_->lines);
  parts_->glyphs.draw_in_slice(scene.glyphs, view, projection);
  parts_->lines.draw(lines_in_slice(scene.lines, view), projection);
  return parts_->report();
}

Result<void> Renderer::draw(const Scene& scene, const Camera3D& view, const Viewport& target) {
  return draw(scene, view, target, nullptr);
}

Result<void> Renderer::draw(const Scene& scene, const Camera3D& view, const Viewport& target, const FaintLayer& faint) {
  return draw(scene, view, target, &faint);
}

Result<void> Renderer::draw_faint(const Scene& scene, const Camera3D& view, const FaintLayer& layer) {
  const Viewport target{0, 0, layer.width_px(), layer.height_px(), 1};
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, layer.parts_->framebuffer.name());
  const Drawing drawing(target, std::array<float, 4>{});
  const Projection projection = projection_of(view, target);
  glEnable(GL_DEPTH_TEST);
  parts_->meshes.update(scene.meshes);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  parts_->draw_planes(scene, projection, is_solid);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  parts_->meshes.draw_transparent(projection);
  return parts_->report();
}

Result<void> Renderer::draw(const Scene& scene, const Camera3D& view, const Viewport& target, const FaintLayer* faint) {
  if (target.width <= 0 || target.height <= 0) return {};
  const Drawing drawing(target, scene.background);
  const Projection projection = projection_of(view, target);
  glEnable(GL_DEPTH_TEST);
  parts_->meshes.update(scene.meshes);
  parts_->draw_planes(scene, projection, [](const PlaneInSpace& part) { return part.behind_meshes; });
  glClear(GL_DEPTH_BUFFER_BIT);
  parts_->draw_planes(scene, projection, is_solid);
  if (std::any_of(scene.planes.begin(), scene.planes.end(), is_solid)) parts_->meshes.draw_hidden(projection);
  parts_->meshes.draw_opaque(projection);
  parts_->glyphs.draw(scene.glyphs, projection);
  std::vector<LineInstance> lines;
  for (const LineLayer::Line& line : scene.lines.lines) lines.push_back(instance_of(line));
  parts_->lines.draw(lines, projection);
  glDepthMask(GL_FALSE);
  parts_->draw_planes(scene, projection,
                      [](const PlaneInSpace& part) { return !part.behind_meshes && part.opacity < 1; });
  glDepthMask(GL_TRUE);
  if (faint != nullptr) parts_->lay_in(faint->parts_->colour, faint->parts_->depth, target);
  parts_->meshes.draw_transparent(projection);
  return parts_->report();
}

}  // namespace homolog
