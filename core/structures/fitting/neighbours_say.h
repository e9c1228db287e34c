#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/structures/fitting/fit_set.h"

namespace homolog {

/// Whether where a structure was fitted counts for others.
inline bool has_a_say(const FittedStructure& one) {
  return one.fit && !one.judgement.doubtful;
}

/// The mean of points.
inline Vec3 middle_of(const Points& points) {
  return points.colwise().mean();
}

/// The similarity of several templates of a set to their fits, which there must be: how the body lies, and its size.
Similarity similarity_of_fits(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                              const std::vector<std::size_t>& which);

/// The four structures nearest to a place of the set that were fitted without doubt, the nearest first; less those that
/// lie far from what the others say.
std::vector<std::size_t> near_structures(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                         std::size_t of);

/// The place where a structure's neighbours say that it is: the similarity that carries near_structures, as they lie in
/// the set, to where they were fitted. None where there are none.
std::optional<Similarity> said_by_neighbours(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                             std::size_t of);

/// The same for a place of the subject, of which the set has no structure (LPS mm): the nearest by where they were
/// fitted.
std::optional<Similarity> said_by_neighbours_at(const SetOfTemplates& set, const std::vector<FittedStructure>& fitted,
                                                const Vec3& place_mm);

/// The shape that is expected of each structure: its template where its neighbours say, then moved onto what the map
/// has of it, as one that may lack parts or have too much. None where no neighbour says, or where the template itself
/// is cut off. `progress` may cancel the work; what is left out then has none.
std::vector<std::optional<Mesh>> expected_shapes(const SetOfTemplates& set, const SetInMap& subject,
                                                 const FittedSet& fitted, const Progress* progress = nullptr);

}  // namespace homolog
