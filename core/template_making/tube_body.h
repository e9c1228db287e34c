#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/template_making/label_body.h"
#include "core/template_making/level_set.h"

namespace homolog {

/// How many times as large as across what makes voxels slices.
inline constexpr double thick_slices = 2;

/// A label of which a tube is made, as voxels.
struct TubeBody {
  LabelBody region;
  Mesh boundary;                       ///< the voxels' boundary
  std::optional<std::string> several;  ///< the warning of other parts
  Vec3 main_axis = Vec3::UnitZ();      ///< along which its voxels spread most, unit; either way

  double volume_mm3() const;
};

/// `united`: a label map in which the tube's labels are 1. `label`: what warnings call it. Errors: it does not occur.
Result<TubeBody> tube_body(const Volume& united, int label);

/// How far the label goes along a direction, up to the outer faces of its outermost voxels: the least and the largest
/// p · axis, mm.
std::pair<double, double> reach_along(const LabelBody& region, const Vec3& axis);

/// The part of the label's volume whose p · axis is below `end_mm`, in mm³.
double volume_below(const LabelBody& region, const Vec3& axis, double end_mm);

/// The middles of the label's sections across an axis, as a line that a tube follows.
class CentreLine {
 public:
  CentreLine(const LabelBody& region, const Vec3& axis);
  /// The point of it at the height p · axis = `height_mm`; beyond its ends straight on along the axis.
  Vec3 at(double height_mm) const;

 private:
  Vec3 axis_;
  std::vector<double> heights_;
  std::vector<Vec3> middles_;
};

/// A body's wall for a tube along an axis, whose apex lies ahead.
struct TubeWall {
  LevelSet wall;
  double base_mm = 0, apex_mm = 0;  ///< p · axis where it ends
  bool flat_base = false;  ///< the label ends at the base with a whole slice: the wall goes straight on beyond it
};

/// If the axis runs along an axis of the grid, the last slices count in full: towards the base the wall goes on
/// beyond their outer faces, and at the apex it closes there. Distances alone would round the label's end off over
/// half a slice all around.
TubeWall tube_wall(const TubeBody& body, const Vec3& axis);

/// How much a mesh and a label have in common, in shares of the label's volume.
struct Overlap {
  double kept = 0;     ///< the part of the label within the mesh
  double extra = 0;    ///< the part of the mesh outside of the label
  double missing = 0;  ///< voxels of the label of which the mesh has less than half: steps of thick slices do not count
  double dice() const { return 2 * kept / (1 + kept + extra); }
};
/// `mesh`: rims closed flat.
Overlap overlap_of(const LabelBody& region, const Mesh& mesh);

/// The axes that a tube may have by default, either way, the likelier first: the slices' normal where slices are thick,
/// else the normal of a flat end (maps of thick slices are often resampled); and the main axis.
std::vector<Vec3> likely_axes(const TubeBody& body);

/// `axis` or its opposite, so that the end ahead holds less of the label.
Vec3 towards_smaller_end(const LabelBody& region, const Vec3& axis);

}  // namespace homolog
