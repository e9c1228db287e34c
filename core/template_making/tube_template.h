#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/measure/compare.h"
#include "core/template_making/label_body.h"

namespace homolog {

struct TubeTemplateOptions {
  int label = 1;                   ///< the label inside the (inner) sheet: the cavity
  std::optional<int> outer_label;  ///< the wall around it: a second sheet around both, at least a voxel
                                   ///< from the inner one, in the same mesh
  int frame = 0;
  int rings = 40, sectors = 64;
  /// From the base to the apex, LPS. Else the slices' normal where slices are thick, or the label's main axis,
  /// whichever gives the template that has more in common with the label; the apex is at the smaller end.
  std::optional<Vec3> axis;
  /// Two points on the axis that someone clicked, LPS mm; they go before `axis`, and the rings begin at the first.
  std::optional<std::pair<Vec3, Vec3>> base_and_apex;
  bool capped = false;  ///< close the base with a flat fan
};

struct TubeTemplate {
  Mesh mesh;  ///< LPS mm; the inner sheet's vertices, then the outer one's, each as tube_triangles() numbers them
  Vec3 axis = Vec3::UnitZ();           ///< unit, from the base to the apex
  SurfaceDistance to_mask, from_mask;  ///< as for MaskTemplate, the base closed flat, both sheets together
  double volume_ml = 0, label_ml = 0;  ///< volumes of the inner sheet, the base closed flat, and of the label's voxels
  double missing_share = 0;            ///< share of the label's voxels of which the inner sheet has less than half
  std::vector<std::string> warnings;
};

/// A template that lacks more of its label than this is said, and what is propagated from it is in doubt.
inline constexpr double most_missing_share = 0.05;

/// "21 % of label 1 is not in the template"; empty where it lacks no more than most_missing_share.
std::string missing_from(const TubeTemplate& made, int label);

/// A reference mesh of a simple, tube-like organ such as the left ventricle [Erdt 2009, §2.1; docs/templates.md]: a
/// regular ring × sector grid, the rings in planes perpendicular to the axis, at equal steps along the wall from the
/// base to the apex, which is closed. Base and apex lie where the label ends, at the outer faces of its end slices.
/// Sector 0 looks to the patient's anterior side (superior where the axis itself does). Errors: the label does not
/// occur, or is so thin or bent that a ring finds no wall; fewer than 2 rings or 3 sectors.
Result<TubeTemplate> make_tube_template(const Volume& mask, const TubeTemplateOptions& options);

}  // namespace homolog
