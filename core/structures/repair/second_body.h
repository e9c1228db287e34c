#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/structures/repair/structure_signs.h"

namespace homolog {

/// Voxels of a map around a structure that are one of its bodies.
struct BodyInMap {
  Neighbourhood there;
  std::vector<std::uint8_t> inside;
};

/// The body of a structure that a map lacks, where another one's label has two: both kidneys in one label, or two
/// levels. Its two largest parts must lie to each other as the two do in the set, in direction and, for their size, in
/// distance: the body is the one that lies where `missing` does. None: the label has no two such bodies. `of` is there.
std::optional<BodyInMap> second_body(const SetOfTemplates& set, const SetInMap& subject, const VolumeRead& map,
                                     int frame, std::size_t missing, std::size_t of);

}  // namespace homolog
