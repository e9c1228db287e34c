#pragma once

#include "core/structures/repair/repair.h"

namespace homolog {

/// Finds what is wrong with the structures of a map whose names are right, and changes its voxels as repair_map says.
/// `result` has what the map is, its fits, the expected shapes and the signs; it gets the defects, and how many voxels
/// changed.
void mend_structures(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options,
                     RepairedMap& result);

}  // namespace homolog
