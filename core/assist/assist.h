#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/adapt/contours/contour_samples.h"
#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/adapt/snap.h"
#include "core/case/action.h"
#include "core/case/actions/history_marks.h"

namespace homolog {

// The automatic steps as edits of a case: each works on the mesh of the frame that is shown and gives the action that
// puts its vertices where it found them. Editor, verbs and experiments all come here.

/// The mesh to work on. `what`: "fit", for the sentence of the error: there is none.
Result<ShapeView> shape_to(const std::string& what, const Document& document, const std::string& of = {});

struct FitEdit {
  SetPoints action;
  FitResult result;
};

/// The edit of a case by which a fit changes the shown mesh; `partial`: with the outliers marked.
SetPoints edit_of_fit(const ShapeView& shown, const FitResult& fit, bool partial);

/// The figures of a fit that a case keeps and a person reads; `mesh` stays empty.
FitFigures figures_of_fit(const FitJudgement& judgement, const FitResult& fit, bool partial);

/// Fits the template [fit.h] with the landmarks that are placed in the case: from where it lies in the case
/// (`as_placed`), else its place is found. `options`: all else. Errors: no mesh, and those of fit_to_boundary().
Result<FitEdit> fit_shape(const ShapeView& shown, const Boundary& boundary, bool as_placed, FitOptions options);

/// The curves that the case holds of a structure in the frame that is shown.
std::vector<DrawnContour> drawn_contours(const ShapeView& shown);

/// The sources that say where the boundary lies between the contours; neither: the shape alone.
struct BetweenContours {
  std::shared_ptr<const Boundary> boundary;  ///< a label's boundary
  std::shared_ptr<const Volume> image;       ///< whose edges count, as `snap` says
  SnapOptions snap;
};

/// Fits the template to the curves that the case holds of the shown frame [contour_fit.h], with the landmarks that are
/// placed. If curves and mesh meet already, it begins with the mesh's placement, else the curves place it. With
/// `goes_on` a mesh that something else than contours made stands in for the template, so that none of that is lost.
/// `options`: all else. Errors: no curves in this frame, and those of fit_to_contours() and snap().
Result<FitEdit> fit_shape_to_contours(const ShapeView& shown, const BetweenContours& between, bool goes_on,
                                      FitOptions options);

/// The part of a mesh that a snap moves: around a surface point, with the falloff of the tools.
struct SnapArea {
  Vec3 at = Vec3::Zero();
  double sigma_mm = 10;
};

struct SnapEdit {
  SetPoints action;
  SnapResult result;      ///< `points` are those that the action gives
  int landmarks = 0;      ///< placed ones that the mesh was held at
  int contours = 0;       ///< curves that the mesh was drawn to
  int pulls = 0;          ///< strokes since the last fit whose part of the mesh was held
  int far_landmarks = 0;  ///< placed ones farther from the mesh than a snap looks; it did not go there
};

/// The vertices that a snap may not move, beside those that are confirmed.
enum class SnapHolds {
  all,       ///< the mesh at placed landmarks and contours, and what was pulled since the last fit [Shape::pulled]
  landmarks  ///< the mesh at placed landmarks: for a snap that finishes a stroke
};

/// Snaps the mesh [snap.h], or the part of it in `region`, to its image; confirmed vertices stay. So does what was
/// pulled, as far as the strokes carried it. Placed landmarks within the reach are met exactly, but where a person
/// released them. So are boundary contours of the frame that are as near and may not lie off. With automatic polarity
/// and no appearance given, what the boundary looks like is learned from the nearest edited frame of a cine. Errors: no
/// mesh, no image, and those of snap().
Result<SnapEdit> snap_shape(const Scan& scan, const ShapeView& shown, const std::optional<SnapArea>& region,
                            const SnapOptions& options, SnapHolds holds = SnapHolds::all);

/// "4 landmarks, 1 contour and 2 pulls"; empty where nothing was held.
std::string held_in_words(const SnapEdit& edit);

struct RefineEdit {
  SetPoints action;
  std::vector<std::string> warnings;  ///< each a sentence
};

/// Refines the mesh [refine.h] with the landmarks placed in the image; confirmed vertices stay. Errors: no mesh, and
/// those of refine().
Result<RefineEdit> refine_shape(const ShapeView& shown, Progress* progress = nullptr);

}  // namespace homolog
