#include "render/offscreen.h"

#include <epoxy/egl.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "render/gl.h"

namespace homolog {
namespace {

constexpr const char* no_context =
    "no OpenGL 3.3 without a display: install libegl1 and libgl1-mesa-dri (software rendering), or the graphics card's "
    "own EGL driver";

bool has(EGLDisplay display, const char* extension) {
  return epoxy_has_egl_extension(display, extension);
}

/// The displays to try, best first: Mesa without any window system, each graphics device, whatever EGL takes.
std::vector<EGLDisplay> displays() {
  std::vector<EGLDisplay> found;
  const bool platforms = has(EGL_NO_DISPLAY, "EGL_EXT_platform_base");
  if (platforms && has(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    found.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
  if (platforms && has(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
      has(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i) {
      found.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
    }
  }
  found.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
  std::erase(found, EGL_NO_DISPLAY);
  return found;
}

struct Egl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

/// A current OpenGL 3.3 core context without a surface; no context where the display gives none.
Egl make_current(EGLDisplay display) {
  if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) return {};
  constexpr std::array<EGLint, 5> config_attributes{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  constexpr std::array<EGLint, 7> context_attributes{
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (eglBindAPI(EGL_OPENGL_API) == EGL_TRUE && has(display, "EGL_KHR_surfaceless_context") &&
      eglChooseConfig(display, config_attributes.data(), &config, 1, &configs) == EGL_TRUE && configs > 0) {
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes.data());
    if (context != EGL_NO_CONTEXT) {
      if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) return {display, context};
      eglDestroyContext(display, context);
    }
  }
  eglTerminate(display);
  return {};
}

}  // namespace

struct OffscreenContext::Parts {
  EGLDisplay display;
  EGLContext context;
};

OffscreenContext::OffscreenContext(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

OffscreenContext::~OffscreenContext() {
  eglMakeCurrent(parts_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(parts_->display, parts_->context);
  eglTerminate(parts_->display);
}

Result<std::unique_ptr<OffscreenContext>> OffscreenContext::make() {
  if (!epoxy_has_egl()) return fail("", no_context);
  for (const EGLDisplay display : displays()) {
    const Egl egl = make_current(display);
    if (egl.context == EGL_NO_CONTEXT) continue;
    return std::unique_ptr<OffscreenContext>(
        new OffscreenContext(std::make_unique<Parts>(Parts{egl.display, egl.context})));
  }
  return fail("", no_context);
}

struct Framebuffer::Parts {
  int width = 0, height = 0;
  gl::Renderbuffer colour, depth, resolved_colour;
  gl::FramebufferObject drawn, resolved;  ///< `resolved` (one sample a pixel) only where `drawn` has several

  /// Binds for reading what holds the picture with one sample a pixel.
  void bind_for_reading() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn.name());
    if (resolved.name() == 0) return;
    GLint draw_before = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_before);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved.name());
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_before));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved.name());
  }
};

Framebuffer::Framebuffer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Framebuffer::~Framebuffer() = default;

Result<std::unique_ptr<Framebuffer>> Framebuffer::make(int width, int height, int samples) {
  GLint largest = 0, most_samples = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  glGetIntegerv(GL_MAX_SAMPLES, &most_samples);
  const std::string size = std::to_string(width) + " × " + std::to_string(height);
  if (width < 1 || height < 1 || width > largest || height > largest) {
    return fail("", "a picture of " + size + " pixels cannot be drawn; this graphics driver takes 1 to " +
                        std::to_string(largest) + " a side");
  }
  const GLsizei used_samples = samples > 1 ? std::min(samples, most_samples) : 0;
  auto parts = std::make_unique<Parts>();
  parts->width = width;
  parts->height = height;
  while (glGetError() != GL_NO_ERROR) {
  }
  parts->colour = gl::Renderbuffer::make();
  glBindRenderbuffer(GL_RENDERBUFFER, parts->colour.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, used_samples, GL_RGBA8, width, height);
  parts->depth = gl::Renderbuffer::make();
  glBindRenderbuffer(GL_RENDERBUFFER, parts->depth.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, used_samples, GL_DEPTH_COMPONENT24, width, height);

  GLint before = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
  if (used_samples > 0) {
    parts->resolved_colour = gl::Renderbuffer::make();
    glBindRenderbuffer(GL_RENDERBUFFER, parts->resolved_colour.name());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    parts->resolved = gl::FramebufferObject::make();
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, parts->resolved.name());
    glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                              parts->resolved_colour.name());
  }
  glBindRenderbuffer(GL_RENDERBUFFER, 0);
  parts->drawn = gl::FramebufferObject::make();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, parts->drawn.name());
  glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, parts->colour.name());
  glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, parts->depth.name());
  const bool complete = glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(before));
  if (!complete || glGetError() != GL_NO_ERROR) {
    return fail("", "a picture of " + size + " pixels does not fit the graphics memory; ask for a smaller one");
  }
  return std::unique_ptr<Framebuffer>(new Framebuffer(std::move(parts)));
}

void Framebuffer::bind() {
  glBindFramebuffer(GL_FRAMEBUFFER, parts_->drawn.name());
}

void Framebuffer::copy_to(int x, int y) const {
  GLint before = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &before);
  parts_->bind_for_reading();
  const int width = parts_->width, height = parts_->height;
  glBlitFramebuffer(0, 0, width, height, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(before));
}

Picture Framebuffer::read() const {
  const auto width = static_cast<std::size_t>(parts_->width), height = static_cast<std::size_t>(parts_->height);
  std::vector<std::uint8_t> rows(4 * width * height);
  GLint before = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &before);
  parts_->bind_for_reading();
  glReadPixels(0, 0, parts_->width, parts_->height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(before));

  Picture picture{parts_->width, parts_->height, std::vector<std::uint8_t>(rows.size())};
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* from = rows.data() + 4 * width * (height - 1 - y);
    std::uint8_t* to = picture.rgba.data() + 4 * width * y;
    for (std::size_t x = 0; x < width; ++x, from += 4, to += 4) {
      const unsigned alpha = from[3];
      for (int channel = 0; channel < 3; ++channel) {
        to[channel] =
            static_cast<std::uint8_t>(alpha == 0 ? 0 : std::min(255u, (255u * from[channel] + alpha / 2) / alpha));
      }
      to[3] = static_cast<std::uint8_t>(alpha);
    }
  }
  return picture;
}

}  // namespace homolog
