#include "render/faint_layer.h"

#include <string>
#include <utility>

#include "render/faint_layer_parts.h"

namespace homolog {
namespace {

gl::Texture make_layer_texture(GLint stored_as, GLenum channels, GLenum type, int width_px, int height_px) {
  gl::Texture texture = gl::Texture::make();
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, stored_as, width_px, height_px, 0, channels, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

}  // namespace

FaintLayer::FaintLayer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
FaintLayer::FaintLayer(FaintLayer&& other) noexcept = default;
FaintLayer& FaintLayer::operator=(FaintLayer&& other) noexcept = default;
FaintLayer::~FaintLayer() = default;

int FaintLayer::width_px() const {
  return parts_->width_px;
}
int FaintLayer::height_px() const {
  return parts_->height_px;
}

Result<FaintLayer> FaintLayer::make(int width_px, int height_px) {
  auto parts = std::make_unique<Parts>();
  parts->width_px = width_px;
  parts->height_px = height_px;
  parts->colour = make_layer_texture(GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, width_px, height_px);
  parts->depth = make_layer_texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, width_px, height_px);
  parts->framebuffer = gl::FramebufferObject::make();
  GLint before = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, parts->framebuffer.name());
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, parts->colour.name(), 0);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, parts->depth.name(), 0);
  const bool complete = glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(before));
  if (!complete) {
    return fail("", "a picture of " + std::to_string(width_px) + " × " + std::to_string(height_px) +
                        " pixels does not fit the graphics memory; make the window smaller");
  }
  return FaintLayer(std::move(parts));
}

}  // namespace homolog
