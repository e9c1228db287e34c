#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/pictures/page.h"
#include "core/base/pictures/picture.h"
#include "core/base/processes/progress.h"
#include "core/case/document.h"
#include "core/model/shape_model.h"
#include "render/scene.h"

namespace homolog {

/// The ground of a picture that is neither light nor transparent.
inline constexpr Rgb dark_ground{0.07f, 0.075f, 0.085f};

/// How a picture is made without a window.
struct MontageOptions {
  int width_px = 1280, height_px = 960;
  Vec3 from = Vec3(0, -1, 0);               ///< the direction to look from, LPS
  double glyph_spacing_mm = 0;              ///< 0: a twelfth of the bounding-box diagonal
  bool transparent = false, light = false;  ///< the ground; dark where neither
  bool captions = false;                    ///< shapes in a grid leave room for them
  double width_mm = 0;  ///< for print at 300 dpi: the height follows what is shown; 0: pixels alone count
  double strip_mm = 0;  ///< for print: kept free below the shapes and their scale bar
};
/// For print: 300 dpi, a light ground, captions. `width_mm`: of the page.
MontageOptions print_options(double width_mm);

/// A part of a picture that shows one thing; px from the upper left corner.
struct PictureCell {
  int x = 0, y = 0, width = 0, height = 0;
  std::string name;      ///< the name of the shape in it
  double mm_per_px = 0;  ///< its own scale bar's, else 0
};

struct MadePicture {
  Picture picture;
  int glyphs = 0;  ///< shown on each shape
  std::vector<PictureCell> cells;
  double mm_per_px = 0;  ///< one for all cells and a scale bar below them; 0: they differ
  int strip_px = 0;      ///< below the cells
  double text_px = 0;    ///< size of the letters that there is room for
};

/// A shape of a montage.
struct MontageCell {
  Mesh mesh;
  std::string name;
  Vec3 from = Vec3(0, -1, 0);                         ///< the direction it is seen from, LPS
  std::shared_ptr<const std::vector<Rgb>> colours{};  ///< one a vertex; null: hues and glyphs of all
};

/// The one maker of grids of shapes: each moved to its centroid, all at one scale, `columns` a row (0: as many as suit
/// the picture). Errors: no OpenGL, more shapes than the picture has room for.
Result<MadePicture> montage(const std::vector<MontageCell>& cells, int columns, const MontageOptions& options);
/// The same, each shape as a picture of its own.
Result<std::vector<Picture>> montage_frames(const std::vector<MontageCell>& frames, const MontageOptions& options,
                                            Progress& progress);

/// A number with three figures and a minus sign as it is printed.
std::string figure(double value);
/// A picture with the names of its cells and scale bars, which lie over no shape.
Page captioned(MadePicture made, const MontageOptions& options);

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

/// The cells of that picture.
Result<std::vector<MontageCell>> cells_of_modes(const ShapeModel& model, int modes, const Vec3& from);
/// One mode as it plays: from the mean to +3√λ, to −3√λ and back, `frames` shapes.
std::vector<MontageCell> playing_mode(const ShapeModel& model, Eigen::Index mode, int frames, const Vec3& from);

/// A case as the paper's Fig. 3: axial, sagittal and coronal slice through the mesh's middle with its outline, and the
/// shape in 3D. Errors: no OpenGL, a case without a mesh.
Result<MadePicture> case_picture(const Document& document, const MontageOptions& options);

}  // namespace homolog
