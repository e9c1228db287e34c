#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/case/session.h"
#include "core/mesh/topology.h"

namespace homolog {

/// How the scripted user works. Lengths in mm.
struct ScriptedUserOptions {
  double visible_mm = 0.5;  ///< deviations below this are not seen (a voxel, for label maps)
  int most_pulls = 120;
  Progress* progress = nullptr;
};

struct ScriptedUserResult {
  int pulls = 0;
  double largest_deviation_mm = 0;  ///< left at the end, both directions
};

/// Places the session's template on the surface `target` as a person would with the handles: patient axes kept but for
/// a tilt, position and size by the target's (one committed placement). Closed-form steps of closest points, proper
/// rotations of at most 40° only.
Result<void> place_on(EditSession& session, const Mesh& target);

/// Adapts the session's mesh to `target` by boundary pulls in axial, sagittal and coronal slices: always the largest
/// visible deviation, in both directions (mesh outside the target, and target not reached by the mesh), σ from large to
/// small. Every pull is committed to the session (and so to its journal). Deterministic. Errors: the session's.
Result<ScriptedUserResult> pull_to_target(EditSession& session, const Mesh& target,
                                          const ScriptedUserOptions& options = {});

}  // namespace homolog
