#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/structures/fitting/fit_set.h"
#include "core/structures/repair/defects.h"
#include "core/structures/repair/structure_signs.h"
#include "core/structures/set_model.h"
#include "core/structures/variants.h"

namespace homolog {

/// The findings on a structure, and what is proposed.
struct RepairedStructure {
  std::vector<Defect> defects;
  double confidence = 0;      ///< 0…1: that it is right as the map has it [structure_confidence]
  double p_named = 1;         ///< 0…1: that its name is the right one
  std::string proposed_name;  ///< its own where nothing else is proposed
  std::size_t structure =
      0;  ///< the set's structure whose template its fit is: that of the proposed name, where the set has it
  std::size_t changed_voxels = 0;
};

struct RepairedMap {
  /// In the set's order, by the names that the map gave. Defects name others as they are called now.
  std::vector<RepairedStructure> structures;
  FittedSet fitted;  ///< the fit to the map as it was, but with the names that are proposed
  std::vector<StructureSigns> signs;
  std::vector<std::optional<Mesh>> expected;  ///< by the neighbours, of the map as it was; of one that was missing and
                                              ///< is filled in, the shape that it got
  SetInMap subject;                           ///< as it was
  std::vector<Variant> variants;              ///< of its levels, which are no defects
  /// Labels without a template that were renamed with the others, and their new names.
  std::vector<std::pair<std::string, std::string>> renamed_without;
};

struct MapRepairOptions {
  const Volume* image = nullptr;  ///< the scan that the map is of; what is filled in goes to the boundary that it shows
  int image_frame = 0;
  const SetModel* model = nullptr;  ///< says how what is missing lies and looks, and what shapes are likely
  Progress* progress = nullptr;
  std::function<void(std::size_t structure, SetFitStep step)> tell{};  ///< called as FitSetOptions::tell, for every fit
};

/// Finds what is wrong with the structures of a label map, and changes its voxels as it proposes: islands go, holes are
/// filled, parts come back from neighbours, what is missing is filled in as the template and the neighbours say, or
/// the joint model, and the image where there is one. Voxels of structures that are sound stay as they are; so does
/// what nothing proposes. Errors: cancelled.
Result<RepairedMap> repair_map(const SetOfTemplates& set, VolumeRead& map, int frame,
                               const MapRepairOptions& options = {});

}  // namespace homolog
