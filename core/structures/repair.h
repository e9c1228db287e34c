#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/structures/defects.h"
#include "core/structures/fit_set.h"
#include "core/structures/structure_signs.h"

namespace homolog {

/// What was found of a structure, and what is proposed.
struct RepairedStructure {
  std::vector<Defect> defects;
  double confidence = 0;      ///< 0…1: that it is right as the map has it [structure_confidence]
  double p_named = 1;         ///< 0…1: that its name is the right one
  std::string proposed_name;  ///< its own where nothing else is proposed
  std::size_t changed_voxels = 0;
};

struct RepairedMap {
  std::vector<RepairedStructure> structures;  ///< in the set's order
  FittedSet fitted;                           ///< to the map as it was
  std::vector<StructureSigns> signs;
  SetInMap subject;
};

/// Finds what is wrong with the structures of a label map, and changes its voxels as it proposes: islands go, holes are
/// filled, parts come back from neighbours, what is missing is filled in as the template and the neighbours say. Voxels
/// of structures that are sound stay as they are; so does what nothing proposes. Errors: cancelled.
Result<RepairedMap> repair_map(const SetOfTemplates& set, VolumeRead& map, int frame, Progress* progress = nullptr);

}  // namespace homolog
