#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/structures/fitting/fit_set.h"

namespace homolog {

/// The structures of a set whose names say a level in the same way, as all vertebrae.
struct LevelChain {
  std::map<int, std::size_t> by_level;  ///< their places in the set, by level
  /// The number to add to the level that the name says, so that all agree with the most of them. It has those that a
  /// map has and whose fit tells where they are; 0 for nearly all.
  std::map<std::size_t, int> apart;
  std::vector<std::size_t> from_above;  ///< the same, in the order in which they lie

  /// How many of them need `by` levels added, as a share of all.
  double share(int by) const;
  /// In how many levels their names err if all of `apart` is `by` more. A stretch of names that are off alike errs
  /// once, however long it is: who counts wrongly goes on so.
  int errors(int by) const;
};

/// The chains of a set, and how their structures lie in a map: two that are one level apart by their names, but two by
/// their places, contradict each other. A shift at the border of chest and loin is a variant (11 or 13 ribs),
/// and no contradiction. `placed`: 1 for each structure whose place tells something.
std::vector<LevelChain> level_chains(const SetOfTemplates& set, const FittedSet& fitted,
                                     const std::vector<char>& placed);

/// Says in how many levels the ends of a chain err whose `apart` is all `by` more: levels below the last one within the
/// map that nobody labelled, a sixth lumbar vertebra, or one above the first cervical one.
int errors_at_ends(const SetInMap& subject, const FittedSet& fitted, const LevelChain& chain, int by);

/// So many levels below its names a whole chain may be.
inline constexpr std::array level_shifts{-2, -1, 1, 2};

/// How much likelier something is if a chain is moved by each of level_shifts: the logarithm. None: nothing tells.
using LevelEvidence = std::array<std::optional<double>, level_shifts.size()>;

/// How much likelier a chain lies, beside the placed structures that do not belong to it, if it is moved from what
/// `apart` leaves of it. `chains`: all, by which others too may be of another level than their names say. None where
/// no other structure tells, or the set does not have that level.
LevelEvidence level_evidence_of_others(const SetOfTemplates& set, const FittedSet& fitted,
                                       const std::vector<char>& placed, const std::vector<LevelChain>& chains,
                                       std::size_t of);

}  // namespace homolog
