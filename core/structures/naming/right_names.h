#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/structures/fitting/fit_set.h"
#include "core/structures/repair/defects.h"
#include "core/structures/repair/structure_signs.h"

namespace homolog {

/// Findings on the name that a label map gives a structure.
struct NameFound {
  std::string proposed;         ///< its own where nothing else is proposed
  double p_named = 1;           ///< 0…1: that its own is right
  std::vector<Defect> defects;  ///< a level that is shifted, or sides that are exchanged
};

/// Tells which structures have each other's names, or those of other levels [name_levels.h]. One for each structure of
/// the set. `progress` may cancel the work; names are then as they are.
std::vector<NameFound> find_names(const SetOfTemplates& set, const SetInMap& subject, const FittedSet& fitted,
                                  const std::vector<StructureSigns>& signs, const Progress* progress = nullptr);

/// Notes of each fit how likely its name is right, as find_names says. One that has likely another's name is doubtful,
/// and its confidence is the less.
void doubt_names(const SetOfTemplates& set, const VolumeRead& map, int frame, const SetInMap& subject,
                 FittedSet& fitted);

/// Takes back proposals that would give two structures of the map one name, which would make them one label. Levels
/// that together have about the size of one become it. `sizes`: a share each of what is usual; empty: all are whole.
void settle_clashes(const SetOfTemplates& set, const SetInMap& subject, std::vector<NameFound>& names,
                    const std::vector<double>& sizes = {});

/// Whether any other name is proposed.
bool any_renamed(const SetOfTemplates& set, const std::vector<NameFound>& names);

/// Gives the labels of a map, in one of its frames, the names that are proposed: their voxels get the values of those
/// names. Names that the map lacks are added with a free value; a map without names keeps the labels whose new name the
/// set lacks. Labels of levels that the set lacks, as a sixth lumbar vertebra, go along with the nearest one, where
/// that gives them a name of the set.
struct RenamedLabels {
  std::vector<std::size_t> voxels;                           ///< that changed, of each structure
  std::vector<std::pair<std::string, std::string>> without;  ///< the labels that the set lacks, and their new names
};
RenamedLabels rename_labels(const SetOfTemplates& set, const SetInMap& subject, const std::vector<NameFound>& names,
                            VolumeRead& map, int frame);

}  // namespace homolog
