#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/mesh/colours.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"
#include "render/outlines.h"

namespace homolog {

/// The content of a picture, as a value: drawing it changes nothing in it, and the same scene gives the same picture in
/// the window and without a display. Large parts are shared; the renderer uploads one again only when its address or
/// `revision` changed. Scenes that are equal give the same picture: their large parts are the same objects.

struct ImageLayer {
  std::shared_ptr<const Volume> volume;  ///< nothing is drawn where null
  int frame = 0;
  double window_low = 0, window_high = 1;  ///< intensity shown black and white
  bool linear = true;                      ///< trilinear, else nearest voxel
  bool operator==(const ImageLayer&) const = default;
};

struct LabelLayer {
  std::shared_ptr<const Volume> labels;  ///< any grid; resliced by nearest voxel, coloured by label_colour()
  int frame = 0;
  float opacity = 0.4f;                               ///< twice that on the edges of a label
  std::shared_ptr<const std::map<int, Rgb>> colours;  ///< the colours that the map gives; null where it gives none
  std::shared_ptr<const std::set<int>> hidden{};      ///< labels that are not drawn; null: all are
  bool operator==(const LabelLayer&) const = default;
};

/// A mesh without colours of its own has this one: bone.
inline constexpr Rgb mesh_colour{0.93f, 0.88f, 0.80f};

struct MeshLayer {
  std::shared_ptr<const Topology> topology;
  std::shared_ptr<const Points> points;
  std::uint64_t points_revision = 0;
  std::shared_ptr<const std::vector<Rgb>> colours;  ///< one a vertex; null is mesh_colour
  std::uint64_t colours_revision = 0;
  bool outline = true;                 ///< its intersection with slice planes, exact, anti-aliased
  std::shared_ptr<Outlines> outlines;  ///< the outlines to look in; null: they are worked out each time
  float outline_px = 2;                ///< times the content scale
  float outline_opacity = 1;
  bool surface = true;  ///< shaded in the 3D view; below opacity 1 drawn after all else
  float surface_opacity = 1;
  bool yields = false;            ///< where it lies on another surface, that one is seen
  bool wireframe = false;         ///< its edges over the surface
  bool saturated_outline = true;  ///< outline colours at full saturation, for contrast on grey
  bool operator==(const MeshLayer&) const = default;
};

/// Spheres in the 3D view; the discs in which they meet the plane in slices.
struct GlyphLayer {
  struct Glyph {
    Vec3 position = Vec3::Zero();
    Rgb colour{1, 1, 1};
    float radius_mm = 1;
    bool operator==(const Glyph&) const = default;
  };
  std::vector<Glyph> glyphs;
  bool operator==(const GlyphLayer&) const = default;
};

/// Straight lines in mm (axes, rulers), drawn with a width in px in the 3D view and in every slice in whose plane both
/// ends lie within half a pixel.
struct LineLayer {
  struct Line {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    std::array<float, 4> colour{1, 1, 1, 1};
    float width_px = 1;
    bool operator==(const Line&) const = default;
  };
  std::vector<Line> lines;
  bool operator==(const LineLayer&) const = default;
};

/// A plane through the volume: `right` and `down` on the screen are unit vectors in LPS; the plane holds `centre`.
struct SliceView {
  Vec3 centre = Vec3::Zero();  ///< the middle of the view, mm
  Vec3 right = Vec3::UnitX(), down = Vec3::UnitY();
  double mm_per_px = 1;
  Vec3 normal() const { return right.cross(down); }  ///< into the screen
  bool operator==(const SliceView&) const = default;
};

/// A camera that looks at `target`. `to_eye` and `up` are directions in LPS, not parallel. `fov_deg` is seen across the
/// shorter side of the view; 0 is orthographic, as large as 30° show the target. Anything nearer to the eye than
/// distance_mm / 50 is cut off.
struct Camera3D {
  Vec3 target = Vec3::Zero();
  Vec3 to_eye = Vec3(0, -1, 0);
  Vec3 up = Vec3::UnitZ();
  double distance_mm = 400;
  double fov_deg = 30;
  bool operator==(const Camera3D&) const = default;
};

/// The slice planes shown in the 3D view with the image on them.
struct PlaneInSpace {
  SliceView plane;
  double half_width_mm = 100, half_height_mm = 100;
  std::array<float, 3> frame_colour{1, 1, 1};
  float opacity = 1;  ///< below 1 it lets all be seen through it; at 1 it cuts meshes, whose rest shines through
  bool behind_meshes = false;  ///< hides nothing of a mesh, wherever it lies
  bool operator==(const PlaneInSpace&) const = default;
};

struct Scene {
  ImageLayer image;
  LabelLayer labels;
  std::vector<MeshLayer> meshes;
  GlyphLayer glyphs;
  LineLayer lines;
  std::vector<PlaneInSpace> planes;  ///< 3D view only
  /// Alpha 0 leaves what is not drawn on transparent; nothing draws over the picture that is there.
  std::optional<std::array<float, 4>> background{{0, 0, 0, 1}};
  bool operator==(const Scene&) const = default;
};

}  // namespace homolog
