#pragma once

#include "render/gl.h"
#include "render/projection.h"
#include "render/scene.h"
#include "render/volume_textures.h"

namespace homolog {

/// The image and its label map on a plane: one shader for all planes, in slices and in space.
class SlicePass {
 public:
  static Result<SlicePass> make();
  /// Draws where the image or a label is, over what is there.
  void draw(const Scene& scene, const PlaneInSpace& part, const Projection& projection);
  /// See VolumeTextures.
  std::optional<std::string> take_complaint() { return textures_.take_complaint(); }

 private:
  gl::Program plain_, labelled_;
  gl::VertexArray no_attributes_;
  gl::Texture label_colours_;
  int last_label_ = 1;                                     ///< the last label of which label_colours_ has a colour
  std::shared_ptr<const std::map<int, Rgb>> own_colours_;  ///< the colours that label_colours_ holds
  std::shared_ptr<const std::set<int>> hidden_;            ///< whose colours are clear in it
  VolumeTextures textures_;
};

}  // namespace homolog
