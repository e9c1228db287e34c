#pragma once

#include <optional>

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The effect of a drag; the method and its limits are in docs/editing.md. What each is called, and does, is a row of
/// stroke_kinds.h.
enum class Tool {
  pull,   ///< the surface to the cursor along its normal [Erdt 2009, §2.2, Fig. 2c]
  grab,   ///< a feature with its vertices, normal and lateral
  slide,  ///< vertices along the surface, which stays
  relax   ///< back towards the reference's local shape, under the brush
};

/// How strokes move the mesh. `paper` is the literal [Erdt 2009, §2.2], kept as the baseline of comparisons; `raw` has
/// no optimisation at all. Deviates from §2.2 in the default, `anchored`: an edit never relaxes an earlier one and does
/// not depend on the mouse's event rate (docs/method.md).
enum class Scheme { anchored, paper, raw };

/// One finished drag of a tool (or, while it is previewed, the drag so far). Points in LPS mm.
struct Stroke {
  Tool tool = Tool::pull;
  Vec3 at = Vec3::Zero();  ///< snaps to the nearest surface point
  Vec3 to = Vec3::Zero();  ///< the cursor
  double sigma_mm = 10;    ///< the width of the Gaussian falloff; at least half an edge is used
  std::optional<Vec3>
      on;  ///< the place on the gesture-start surface where a pull ended; absent: found by following the cursor
  bool through_space = false;  ///< the falloff reaches other sheets too
  double strength = 1;         ///< Relax only, 0…1
  bool operator==(const Stroke&) const = default;
};

}  // namespace homolog
