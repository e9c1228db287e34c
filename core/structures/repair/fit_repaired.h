#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/structures/repair/repair.h"

namespace homolog {

/// The repair of a map that a person looks at and decides on: shapes as they are proposed, and as they were.
struct RepairedFit {
  SetInMap subject;                            ///< the set in the map as proposed
  FittedSet fitted;                            ///< the fit to that map; confidences are those of the map as it was
  std::vector<std::string> found;              ///< a sentence on each structure; empty: nothing is wrong with it
  std::vector<std::optional<Points>> as_read;  ///< n×3, LPS mm: fits to the map as it was; none: it was missing
};

/// Repairs the frame of a map [repair_map] and fits the set to what is proposed. All are in the set's order, by the
/// names that are proposed. The fit leaves `gap_mm` between neighbours. Errors: cancelled.
Result<RepairedFit> fit_repaired(const SetOfTemplates& set, VolumeRead& map, int frame,
                                 const MapRepairOptions& options = {}, double gap_mm = 0);

}  // namespace homolog
