#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/adapt/fit.h"
#include "core/adapt/snap.h"
#include "core/case/action.h"

namespace homolog {

// The automatic steps as edits of a case: each works on the mesh of the frame that is shown and gives the action that
// puts its vertices where it found them. Editor, verbs and experiments all come here.

struct FitEdit {
  SetPoints action;
  FitResult result;
};

/// Fits the template [fit.h] with the landmarks that are placed in the case: from where it lies in the case
/// (`as_placed`), else its place is found. `options`: all else. Errors: no mesh, and those of fit_to_boundary().
Result<FitEdit> fit_document(const Document& document, const Boundary& boundary, bool as_placed, FitOptions options);

/// The part of a mesh that a snap moves: around a surface point, with the falloff of the tools.
struct SnapArea {
  Vec3 at = Vec3::Zero();
  double sigma_mm = 10;
};

struct SnapEdit {
  SetPoints action;
  SnapResult result;  ///< `points` are those that the action gives
};

/// Snaps the mesh [snap.h], or the part of it in `region`, to its image; confirmed vertices stay. With automatic
/// polarity and no appearance given, what the boundary looks like is learned from the nearest edited frame of a cine.
/// Errors: no mesh, no image, and those of snap().
Result<SnapEdit> snap_document(const Document& document, const std::optional<SnapArea>& region,
                               const SnapOptions& options);

struct RefineEdit {
  SetPoints action;
  std::vector<std::string> warnings;  ///< each a sentence
};

/// Refines the mesh [refine.h] with the landmarks placed in the image; confirmed vertices stay. Errors: no mesh, and
/// those of refine().
Result<RefineEdit> refine_document(const Document& document, Progress* progress = nullptr);

}  // namespace homolog
