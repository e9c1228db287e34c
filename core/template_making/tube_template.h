#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/measure/compare.h"
#include "core/template_making/label_body.h"

namespace homolog {

struct TubeTemplateOptions {
  int label = 1;                   ///< what lies inside the (inner) sheet: the cavity
  std::optional<int> outer_label;  ///< the wall around it: a second sheet around both, at least a voxel
                                   ///< from the inner one, in the same mesh
  int frame = 0;
  int rings = 40, sectors = 64;
  std::optional<Vec3>
      axis;  ///< from the base to the apex, LPS; else the organ's main axis, the apex at the narrower end
  /// Two points on the axis that someone clicked, LPS mm; they go before `axis` and bound the rings.
  std::optional<std::pair<Vec3, Vec3>> base_and_apex;
  bool capped = false;  ///< close the base with a flat fan
};

struct TubeTemplate {
  Mesh mesh;  ///< LPS mm; the inner sheet's vertices, then the outer one's, each as tube_triangles() numbers them
  Vec3 axis = Vec3::UnitZ();           ///< unit, from the base to the apex
  SurfaceDistance to_mask, from_mask;  ///< as for MaskTemplate, the base closed flat, both sheets together
  std::vector<std::string> warnings;
};

/// A reference mesh of a simple, tube-like organ such as the left ventricle [Erdt 2009, §2.1; docs/templates.md]: a
/// regular ring × sector grid, the rings in planes perpendicular to the axis, at equal steps along the wall from the
/// base to the apex, which is closed. Sector 0 looks to the patient's anterior side (superior where the axis itself
/// does). Errors: the label does not occur, or is so thin or bent that a ring finds no wall.
Result<TubeTemplate> make_tube_template(const Volume& mask, const TubeTemplateOptions& options);

}  // namespace homolog
