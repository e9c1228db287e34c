#pragma once

#include <optional>
#include <vector>

#include "core/structures/fit_set.h"

namespace homolog {

/// What the shapes of a spine say of its levels.
struct LevelEvidence {
  /// By how many levels all names should move: 1 where each vertebra is rather the next one down.
  int shift = 0;
  double p_as_named = 1;  ///< 0…1: that the names are right
};

/// Compares each vertebra with the templates of its level and of those above and below: the wrong ones lie farther
/// from it, most of all where several say the same. `sound`: 1 for each structure whose form tells something. None
/// where fewer than three vertebrae do.
std::optional<LevelEvidence> level_evidence(const SetOfTemplates& set, const SetInMap& subject,
                                            const std::vector<char>& sound);

}  // namespace homolog
