#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/case/document.h"
#include "core/deform/deformer.h"

namespace homolog {

// Every change that a user (or a case file) can make. Each has one line in the case file; see docs/case-file.md.

struct SetPlacement {
  Similarity placement;
  bool operator==(const SetPlacement&) const = default;
};
/// Sets w to `value` within `radius_mm` of `at`; over the outer share `soft` of the radius it blends with what was
/// there.
struct PaintStiffness {
  Vec3 at = Vec3::Zero();
  double radius_mm = 10, value = 10, soft = 0;
  bool operator==(const PaintStiffness&) const = default;
};
/// Draws each factor within `radius_mm` towards the mean of its one-ring; the edge of the brush is soft.
struct SmoothStiffness {
  Vec3 at = Vec3::Zero();
  double radius_mm = 10, strength = 0.5;
  bool operator==(const SmoothStiffness&) const = default;
};
/// Brings the vertices under the brush into a named region and gives them its factor. Without a name it takes them out
/// of every region; their factor is 1 then.
struct PaintRegion {
  std::string name;
  Vec3 at = Vec3::Zero();
  double radius_mm = 10, soft = 0;
  bool operator==(const PaintRegion&) const = default;
};
/// Brings all vertices that are connected with the one nearest to `at` into a region. By::region takes those of the
/// same region; By::curvature takes of these only the ones whose mean curvature differs by at most a tolerance.
struct FillRegion {
  enum class By { region, curvature };
  std::string name;
  Vec3 at = Vec3::Zero();
  By by = By::region;
  double tolerance_per_mm = 0.05;
  bool operator==(const FillRegion&) const = default;
};
/// Adds a region, or gives the one of that name another factor and colour. The factors of its vertices change by the
/// same ratio.
struct SetRegion {
  Region region;
  bool operator==(const SetRegion&) const = default;
};
struct RenameRegion {
  std::string name, to;
  bool operator==(const RenameRegion&) const = default;
};
/// Removes a region; its vertices keep their factors.
struct RemoveRegion {
  std::string name;
  bool operator==(const RemoveRegion&) const = default;
};
/// Gives every vertex a factor, from an array of a mesh file.
struct SetStiffnessFactors {
  std::shared_ptr<const VertexScalars> factors;
  bool operator==(const SetStiffnessFactors& other) const {
    return factors == other.factors || (factors && other.factors && *factors == *other.factors);
  }
};
/// Names the point of the template's surface that lies nearest to `at` on the mesh as it is now, moves that landmark,
/// or (without a position) takes it away.
struct SetTemplateLandmark {
  std::string name;
  std::optional<Vec3> at;
  bool operator==(const SetTemplateLandmark&) const = default;
};
/// Values of SetPoints::by that say nothing of where the boundary is: a study's shape model moved the vertices, or they
/// moved along the surface.
inline constexpr const char* by_model = "model help";
inline constexpr const char* by_refinement = "refine";
/// Puts every vertex where an automatic step found it: a fit, a snap, a shape model. The points themselves are kept, so
/// replaying needs neither that step nor its image.
struct SetPoints {
  std::string by;                        ///< what found them: "fit", or one of those above, which count otherwise
  std::optional<Similarity> placement;   ///< the reference moves there; unwarped then
  std::shared_ptr<const Points> points;  ///< n×3, LPS mm
  bool operator==(const SetPoints& other) const {
    return by == other.by && placement == other.placement &&
           (points == other.points || (points && other.points && *points == *other.points));
  }
};
/// SetPoints as a case keeps it: how far each coordinate moved, in steps of 2⁻¹⁶ mm [moved_points.h].
struct MovePoints {
  std::string by;
  std::optional<Similarity> placement;
  std::shared_ptr<const std::vector<std::uint32_t>> moves;  ///< 3n, landmark by landmark; 0 stays
  bool operator==(const MovePoints& other) const {
    return by == other.by && placement == other.placement &&
           (moves == other.moves || (moves && other.moves && *moves == *other.moves));
  }
};
struct SetStiffnessBase {
  double base = default_stiffness_base;
  bool operator==(const SetStiffnessBase&) const = default;
};
/// Holds (or frees) the vertices within `radius_mm` of `at`: later strokes leave held ones where they are.
struct Confirm {
  Vec3 at = Vec3::Zero();
  double radius_mm = 10;
  bool hold = true;
  bool operator==(const Confirm&) const = default;
};
struct SetScheme {
  Scheme scheme = Scheme::anchored;
  int paper_events = 1;
  bool operator==(const SetScheme&) const = default;
};
struct SetSpacing {
  double strength = 0;
  bool operator==(const SetSpacing&) const = default;
};
/// Places a named landmark in the image, moves it, or (without a position) takes it away.
struct PlaceLandmark {
  std::string name;
  std::optional<Vec3> at;
  bool operator==(const PlaceLandmark&) const = default;
};
struct SetLandmarkFit {
  LandmarkFit fit = LandmarkFit::warp;
  bool operator==(const SetLandmarkFit&) const = default;
};
/// Turns the template into that of the other side (same numbering); the shape starts anew at its placement.
struct MirrorTemplate {
  bool operator==(const MirrorTemplate&) const = default;
};
/// Shows a frame; one that has no shape yet gets the template at the last frame's placement. To look is no step of the
/// history: there is nothing to undo, and what can be redone stays so.
struct SetFrame {
  int frame = 0;
  bool step = false;  ///< in older files it was one
  bool operator==(const SetFrame&) const = default;
};
/// Gives the shown frame a copy of another frame's shape.
struct StartFrameFrom {
  int frame = 0;
  bool operator==(const StartFrameFrom&) const = default;
};
struct Note {
  std::string text;
  bool operator==(const Note&) const = default;
};
struct Undo {
  bool operator==(const Undo&) const = default;
};
struct Redo {
  bool operator==(const Redo&) const = default;
};

using Action = std::variant<Stroke, SetPlacement, PaintStiffness, SmoothStiffness, PaintRegion, FillRegion, SetRegion,
                            RenameRegion, RemoveRegion, SetStiffnessFactors, SetPoints, MovePoints, SetStiffnessBase,
                            Confirm, SetScheme, SetSpacing, SetTemplateLandmark, PlaceLandmark, SetLandmarkFit,
                            MirrorTemplate, SetFrame, StartFrameFrom, Note, Undo, Redo>;

/// An action as the journal holds it.
struct EditStep {
  Action action;
  /// Undone and redone together with the one before it: the further touches of a brush stroke, the points of a list.
  bool joined = false;
};

/// The edit that gives a document this shape; coordinates that differ from those of `document` are rounded to 2⁻¹⁶ mm
/// [moved_points.h].
SetPoints points_edit(const Document& document, const Points& points, std::string by,
                      const std::optional<Similarity>& placement = std::nullopt);

/// What an edit did, for the interface: shown during a drag and when it is done.
struct EditReport {
  bool stopped_by_guard = false;  ///< the fold guard (or the quality floor) held the gesture back
  double moved_mm = 0;            ///< of the grabbed point
  std::optional<Vec3> on;         ///< the point of the surface at the gesture's start that the gesture holds
  std::shared_ptr<const VertexScalars> response;  ///< û, 0…1: how far each vertex follows; null where none
  int solves = 0;
  double solver_ms = 0;
  std::string message;  ///< one sentence for the status line; empty where there is nothing to say
};

struct Updated {
  Document document;
  EditReport report;
};

/// The one function that edits a case: the editor, the case file, the command line and the tests all come here.
/// `deformer` caches factorisations and the running gesture. Undo and Redo belong to
/// EditSession and are refused here. Errors: an edit that needs a template or a shape where there is none, values out
/// of range.
Result<Updated> update(const Document& document, const Action& action, Deformer& deformer, Pass pass);

/// A few words for menus: "Undo pull".
std::string action_name(const Action& action);

}  // namespace homolog
