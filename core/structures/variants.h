#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/structures/fitting/fit_set.h"

namespace homolog {

/// A place where a body has other levels than the set: labels between two structures that have more room there than in
/// the set, or less.
struct Variant {
  std::size_t from = 0, to = 0;     ///< the structures on both sides, by their places in the set
  std::vector<Segment> more;        ///< labels of the map without template that lie between them
  std::vector<std::size_t> absent;  ///< the set's structures between them that the map lacks for this reason
};

/// Finds the variants of a map: a sixth lumbar vertebra, or four of them. `fitted`: the set's fits to it.
std::vector<Variant> find_variants(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted);

/// Whether a structure is absent from one of them.
bool is_absent(const std::vector<Variant>& variants, std::size_t structure);

/// A variant for a person: "has L6 between L5 and sacrum, and no disc_L5_S1; this is a variant, not a fault".
std::string sentence_of(const Variant& variant, const SetOfTemplates& set);

}  // namespace homolog
