#pragma once

#include <string>
#include <vector>

#include "core/base/picture.h"
#include "core/case/document.h"
#include "core/model/shape_model.h"
#include "render/scene.h"

namespace homolog {

/// How a picture is made without a window.
struct MontageOptions {
  int width_px = 1280, height_px = 960;
  Vec3 from = Vec3(0, -1, 0);               ///< the direction to look from, LPS
  double glyph_spacing_mm = 0;              ///< 0: a twelfth of the bounding-box diagonal
  bool transparent = false, light = false;  ///< the ground; dark where neither
  bool captions = false;                    ///< shapes in a grid leave room for them
};

/// A part of a picture that shows one thing; px from the upper left corner.
struct PictureCell {
  int x = 0, y = 0, width = 0, height = 0;
  std::string name;      ///< what it shows
  double mm_per_px = 0;  ///< where a scale bar belongs into it, else 0
};

struct MadePicture {
  Picture picture;
  int glyphs = 0;  ///< shown on each shape
  std::vector<PictureCell> cells;
};

/// The direction of "anterior", "posterior", "left", "right", "superior", "inferior" or "x,y,z" (LPS, towards the eye).
Result<Vec3> direction_from_name(const std::string& name);

/// All shapes as a grid under one camera that just shows each: hue by vertex, the same glyphs on each [Erdt 2009,
/// §3.1, Fig. 5]. Shapes are moved to their centroids. `names` are those of the shapes. Errors: no OpenGL, shapes of
/// different topology (the caller names them).
Result<MadePicture> correspondence_picture(const std::vector<Mesh>& shapes, const std::vector<std::string>& names,
                                           const MontageOptions& options);

/// Modes of a model as the paper's Fig. 4: a row a mode, at −3√λ, the mean, and at +3√λ, under one camera, with the
/// colours and glyphs of correspondence_picture. At most `modes` rows. Errors: no OpenGL, a model of points alone.
Result<MadePicture> modes_picture(const ShapeModel& model, int modes, const MontageOptions& options);

/// A case as the paper's Fig. 3: axial, sagittal and coronal slice through the mesh's middle with its outline, and the
/// shape in 3D. Errors: no OpenGL, a case without a mesh.
Result<MadePicture> case_picture(const Document& document, const MontageOptions& options);

}  // namespace homolog
