#pragma once

#include <vector>

#include "core/structures/fitting/fit_set.h"

namespace homolog {

/// Findings on the name of a structure that says a level of the spine.
struct LevelFound {
  int shift = 0;       ///< levels that the name should move by: 1 where it is rather the next one down
  int maybe = 0;       ///< the same where too little speaks for it to move the name; 0 where `shift` is none
  double p_named = 1;  ///< 0…1: that the name is right; 1 where nothing is known
};

/// Tells which names are levels off: of each structure of the set, 0 for those that are of no level. Names of one kind
/// that contradict each other by their places are set right by the most of them. Whether all of them are off is told by
/// where other structures lie, and by the shapes: each vertebra is compared with the templates of its level and of
/// those above and below, most of all where several say the same. `placed`: 1 for each structure whose place tells
/// something, `sound`: whose form does too. `progress` may cancel the work; forms then tell nothing.
std::vector<LevelFound> find_levels(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted,
                                    const std::vector<char>& placed, const std::vector<char>& sound,
                                    const Progress* progress = nullptr);

}  // namespace homolog
