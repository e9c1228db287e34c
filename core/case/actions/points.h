#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/same_values.h"
#include "core/case/actions/kind.h"

namespace homolog {

inline constexpr const char* by_fit = "fit";
inline constexpr const char* by_set_fit = "fit of the set";
/// Values of SetPoints::by that say nothing of where the boundary is: a study's shape model moved the vertices, or they
/// moved along the surface.
inline constexpr const char* by_model = "model help";
inline constexpr const char* by_refinement = "refine";
/// Vertices went along their normals to the edge in the image.
inline constexpr const char* by_snap = "snap";
/// The mesh as it was went to contours that were drawn: what was pulled before is kept.
inline constexpr const char* by_contours = "contours";
/// Vertices went out of a neighbour.
inline constexpr const char* by_keep_apart = "keep apart";
/// The mesh came from other frames of a cine: it does not make the frame a known one.
inline constexpr const char* by_propagation = "propagate";
/// Puts every vertex where an automatic step found it: a fit, a snap, a shape model. The points themselves are kept, so
/// replaying needs neither that step nor its image.
struct SetPoints {
  std::string by;                         ///< what found them: one of those above
  std::optional<Similarity> placement;    ///< the reference moves there; unwarped then
  SharedValue<Points> points;             ///< n×3, LPS mm
  std::optional<int> of_frame{};          ///< of a cine, where it is not the one that is shown
  std::string doubt{};                    ///< of a frame that was carried there: see Shape::doubt
  SharedValue<VertexScalars> doubt_mm{};  ///< of a fit: see Shape::doubt_mm; on doubt_on_grid's grid
  SharedValue<VertexScalars> outlier{};   ///< of a fit: see Shape::outlier; 0 or 1 each
  bool operator==(const SetPoints&) const = default;
};
const ActionKind<SetPoints>& action_kind(const SetPoints&);

/// SetPoints as a case keeps it: how far each coordinate moved, in steps of 2⁻¹⁶ mm [moved_points.h].
struct MovePoints {
  std::string by;
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
SetPoints points_edit(const ShapeView& shown, const Points& points, std::string by,
                      const std::optional<Similarity>& placement = std::nullopt);
/// The same for another frame of a cine.
SetPoints points_edit(const ShapeView& shown, int frame, const Points& points, std::string by);

}  // namespace homolog
