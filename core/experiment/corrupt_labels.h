#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/structures/repair/defects.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The defect of a structure after corrupt_labels.
struct PlantedDefect {
  std::string structure;  ///< its right name
  Defect defect;
};

struct CorruptedLabels {
  VolumeRead map;
  std::vector<PlantedDefect> planted;
};

/// Makes one thing wrong with the structure that has `value` in a label map of one layer, as automatic segmentations
/// get it wrong: which part, how much, with which neighbour, depends on `seed` alone. Errors: the value does not occur;
/// it has no neighbour, level or partner that the kind needs; layers.
Result<CorruptedLabels> corrupt_labels(const VolumeRead& map, int value, DefectKind kind, std::uint64_t seed);

}  // namespace homolog
