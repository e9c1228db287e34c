#pragma once

#include <map>
#include <memory>
#include <string>

#include "app/editor/state/models/models_state.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

/// Small pictures of the study's shapes, from the front, as they lie. Kept until a shape changes, and drawn a few in
/// each frame, so that a long list never holds the window up.
class CaseThumbnails {
 public:
  static constexpr float width = 44, height = 36;  ///< layout units

  CaseThumbnails();
  ~CaseThumbnails();
  /// Draws some of those that are missing, into a framebuffer of its own that stays bound. True where any is left.
  bool draw(const ModelsState& state, float scale, Renderer& renderer);
  /// The OpenGL texture of a case's picture; 0 where there is none (yet).
  unsigned texture(const std::string& name) const;

 private:
  struct Thumbnail;
  std::map<std::string, Thumbnail> thumbnails_;  ///< by case
  std::unique_ptr<Framebuffer> framebuffer_;
  float scale_ = 0;
};

}  // namespace homolog
