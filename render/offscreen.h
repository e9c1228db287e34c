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

/// A framebuffer of a given size (multisampled inside) in the current context, whichever made it.
class Framebuffer {
 public:
  static Result<std::unique_ptr<Framebuffer>> make(int width, int height, int samples = 4);
  ~Framebuffer();
  void bind();
  /// Resolves and reads back what was drawn.
  Picture read();

 private:
  struct Parts;
  explicit Framebuffer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace homolog
