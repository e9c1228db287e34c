#pragma once

#include <memory>

#include "core/base/pictures/picture.h"
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

/// A framebuffer of a given size in the current context, whichever made it: to read back, or to copy.
class Framebuffer {
 public:
  /// `samples` a pixel, as far as the driver goes; 1 is enough for slices. Errors: wider or higher than the driver's
  /// limit, or than its memory holds.
  static Result<std::unique_ptr<Framebuffer>> make(int width, int height, int samples = 4);
  ~Framebuffer();
  void bind();
  /// Copies what was drawn into the framebuffer that is bound, its lower left corner to (x, y): much cheaper than a
  /// textured rectangle where rendering is in software.
  void copy_to(int x, int y) const;
  /// The drawn picture, read back.
  Picture read() const;

 private:
  struct Parts;
  explicit Framebuffer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace homolog
