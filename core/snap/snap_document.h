#pragma once

#include <optional>

#include "core/case/action.h"
#include "core/snap/snap.h"

namespace homolog {

/// The part of a mesh that a snap moves: around a surface point, with the falloff of the tools.
struct SnapRegion {
  Vec3 at = Vec3::Zero();
  double sigma_mm = 10;
};

/// A snap as an edit: the points it gives, and how far they are to be trusted.
struct SnapEdit {
  SetPoints action;
  SnapResult result;  ///< `points` are those that the action gives
};

/// Snaps the shown frame's mesh, or the part of it in `region`, to its image; confirmed vertices stay. With automatic
/// polarity and no appearance given, what the boundary looks like is learned from the nearest edited frame of a cine.
/// Errors: no mesh, no image, and those of snap().
Result<SnapEdit> snap_document(const Document& document, const std::optional<SnapRegion>& region,
                               const SnapOptions& options);

}  // namespace homolog
