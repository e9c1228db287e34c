#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/experiment/sight.h"
#include "core/session/session.h"

// A person at work, scripted: what each function does is committed to the session, and so to its journal.
// Deterministic. Errors of all: the session's.

namespace homolog {

/// Places the session's template on the surface `target` as a person would with the handles: patient axes kept but for
/// a tilt, position and size by the target's.
Result<void> place_on(EditSession& session, const Mesh& target);

/// Moves the placement off by what a person's handiwork leaves, normally distributed: about each axis a turn of 3°,
/// along each a shift of 1.5 % of the template's bounding-box diagonal, and 1.5 % of size.
Result<void> disturb_placement(EditSession& session, std::uint64_t seed);

/// Grabs the template's landmarks that `features` name and drags them to their places with the largest σ, three rounds,
/// since each drag moves its neighbours too. Gives the number of strokes.
Result<int> grab_landmarks(EditSession& session, const std::vector<Landmark>& features);

/// Clicks `features` in the image, so that the landmark warp carries the template along; gives their number.
Result<int> click_landmarks(EditSession& session, const std::vector<Landmark>& features);

/// Confirms a small region around each of `features` (5 % of the template's diagonal), so that later strokes leave them
/// where they are.
Result<void> confirm_landmarks(EditSession& session, const std::vector<Landmark>& features);

/// How boundary pulls are done.
struct PullingOptions {
  double visible_mm = 0.5;  ///< deviations below this are not seen (a voxel, for label maps)
  int most_pulls = 120;
  Progress* progress = nullptr;
  /// Called after each pull with their number so far and what is seen then.
  std::function<void(int pulls, const std::vector<Deviation>& seen)> watch;
};

struct PullingResult {
  int pulls = 0;
  double largest_deviation_mm = 0;  ///< left at the end, both directions
};

/// Adapts the session's mesh to `target` by boundary pulls in axial, sagittal and coronal slices, until nothing visible
/// can be improved. It looks in both directions: at mesh outside the target, and at target that the mesh does not
/// reach. It first pulls the place with the largest total difference within reach of one of the three σ. So large σ
/// come first. It drags as far as fits the surroundings.
Result<PullingResult> pull_to_target(EditSession& session, const Mesh& target, const PullingOptions& options = {});

}  // namespace homolog
