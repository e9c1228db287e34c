#pragma once

#include <string>
#include <vector>

#include "app/editor/state/layout.h"
#include "core/base/picture.h"
#include "core/base/result.h"

namespace homolog {

/// What is written on a part of a picture.
struct PictureCaption {
  RectPx rect;  ///< px from the upper left corner
  std::string name;
  double mm_per_px = 0;  ///< for a scale bar; 0: without one
};

/// Writes names and scale bars on a picture, in colours for a dark or a light ground. Errors: no OpenGL.
Result<void> write_captions(Picture& picture, const std::vector<PictureCaption>& captions, bool light);

}  // namespace homolog
