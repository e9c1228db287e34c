#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/same_values.h"
#include "core/case/actions/kind.h"

namespace homolog {

/// The finder of an edit's points. Two say nothing of where the boundary is: `model` and `refinement`.
enum class FoundBy {
  other,  ///< PointsFinder::word names it
  fit,
  set_fit,
  model,       ///< a study's shape model moved the vertices
  refinement,  ///< vertices moved along the surface
  snap,        ///< vertices went along their normals to the edge in the image
  /// The mesh as it was went to contours that were drawn: what was pulled before is kept.
  contours,
  keep_apart,     ///< vertices went out of a neighbour
  propagation,    ///< the mesh came from other frames of a cine: it does not make the frame a known one
  start_of_cine,  ///< the mesh that went to the other frames
  projection,     ///< vertices went to the closest places of a surface
  shared,         ///< vertices went to where another structure that shares them has them
  taken_back      ///< the mesh of before a repair
};

/// FoundBy and its word in a case. A word that is not known is kept: a script or an older version wrote it.
class PointsFinder {
 public:
  PointsFinder(FoundBy by = FoundBy::other) : by_(by) {}
  explicit PointsFinder(const std::string& word);
  /// The word that a case has, and the words after "Undo".
  std::string word() const;
  bool operator==(const PointsFinder&) const = default;

 private:
  FoundBy by_;
  std::string unknown_;  ///< the word of FoundBy::other
};

/// Puts every vertex where an automatic step found it: a fit, a snap, a shape model. The points themselves are kept, so
/// replaying needs neither that step nor its image.
struct SetPoints {
  PointsFinder by;                        ///< the finder of the points
  std::optional<Similarity> placement;    ///< the reference moves there; unwarped then
  SharedValue<Points> points;             ///< n×3, LPS mm
  std::optional<int> of_frame{};          ///< the frame of a cine, where it is not the one that is shown
  std::string doubt{};                    ///< why a frame that was carried there has to be looked at: see Shape::doubt
  SharedValue<VertexScalars> doubt_mm{};  ///< a fit's doubt: see Shape::doubt_mm; on doubt_on_grid's grid
  SharedValue<VertexScalars> outlier{};   ///< a fit's missing parts: see Shape::outlier; 0 or 1 each
  bool operator==(const SetPoints&) const = default;
};
const ActionKind<SetPoints>& action_kind(const SetPoints&);

/// SetPoints as a case keeps it: how far each coordinate moved, in steps of 2⁻¹⁶ mm [moved_points.h].
struct MovePoints {
  PointsFinder by;
  std::optional<Similarity> placement;
  SharedValue<std::vector<std::uint32_t>> moves;  ///< 3n, vertex by vertex; 0 stays
  std::optional<int> of_frame{};
  std::string doubt{};
  SharedValue<VertexScalars> doubt_mm{}, outlier{};
  bool operator==(const MovePoints&) const = default;
};
const ActionKind<MovePoints>& action_kind(const MovePoints&);

/// A fit's doubt (mm, a value a vertex) as an edit keeps it: in steps of 2⁻⁸ mm.
std::shared_ptr<const VertexScalars> doubt_on_grid(const VertexScalars& doubt_mm);

/// The edit that gives the shown mesh these points (n×3, LPS mm); coordinates that differ from those that it has are
/// rounded to 2⁻¹⁶ mm [moved_points.h].
SetPoints points_edit(const ShapeView& shown, const Points& points, PointsFinder by,
                      const std::optional<Similarity>& placement = std::nullopt);
/// The same for another frame of a cine.
SetPoints points_edit(const ShapeView& shown, int frame, const Points& points, PointsFinder by);

}  // namespace homolog
