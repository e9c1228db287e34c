#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include "app/editor/state/models/models_state.h"
#include "render/offscreen.h"
#include "render/renderer.h"

namespace homolog {

/// Small pictures of the study's shapes, from the front, as they lie. Drawn for the rows that are on the screen, a few
/// in each frame, and kept until a shape changes: so a long list never holds the window up.
class CaseThumbnails {
 public:
  static constexpr float width = 44, height = 36;  ///< layout units

  CaseThumbnails();
  ~CaseThumbnails();
  /// Draws some of those that were asked for since the last call and are missing, into a framebuffer of its own that
  /// stays bound.
  void draw(const ModelsState& state, float scale, Renderer& renderer);
  /// Whether a picture that was asked for since then is to be drawn.
  bool misses_any(const ModelsState& state) const;
  /// The OpenGL texture of a case's picture; 0 where there is none (yet): it is asked for.
  unsigned texture(const std::string& name) const;

 private:
  struct Thumbnail;
  bool misses(const ModelsState& state, const std::string& name) const;

  std::map<std::string, Thumbnail> thumbnails_;  ///< by case
  mutable std::set<std::string> asked_;          ///< cases whose picture is on the screen
  std::shared_ptr<const Topology> faces_;        ///< faces of the shape before
  std::unique_ptr<Framebuffer> framebuffer_;
  float scale_ = 0;
};

}  // namespace homolog
