#pragma once

#include <memory>

#include "core/base/picture.h"
#include "core/base/result.h"

namespace homolog {

/// An OpenGL context without a display: EGL surfaceless, else device, else the default display.
class OffscreenContext {
 public:
  /// Errors: no EGL platform gives OpenGL 3.3; the sentence names the packages that would.
  static Result<std::unique_ptr<OffscreenContext>> make();
  ~OffscreenContext();

 private:
  struct Parts;
  explicit OffscreenContext(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// A framebuffer of a given size in the current context, whichever made it: to read back, or to show as a texture.
class Framebuffer {
 public:
  /// `samples` a pixel, as far as the driver goes; 1 is enough for slices. Errors: wider or higher than the driver's
  /// limit, or than its memory holds.
  static Result<std::unique_ptr<Framebuffer>> make(int width, int height, int samples = 4);
  ~Framebuffer();
  void bind();
  /// What was drawn, as an OpenGL texture (GL_TEXTURE_2D, first row at the bottom, premultiplied) that lives as long as
  /// this; good until the next draw.
  unsigned int texture();
  /// What was drawn, read back.
  Picture read();

 private:
  struct Parts;
  explicit Framebuffer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace homolog
