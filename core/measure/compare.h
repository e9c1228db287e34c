#pragma once

#include <optional>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// How well two closed surfaces agree. Distances are surface to surface, area-weighted, both directions, in mm.
struct Agreement {
  double dice = 0;
  double assd_mm = 0;                                   ///< average symmetric surface distance
  double hd95_mm = 0;                                   ///< the larger of the two directions' 95th percentiles
  double hausdorff_mm = 0;                              ///< the largest distance either way
  std::optional<double> vertex_mean_mm, vertex_max_mm;  ///< between equal indices, where topologies are equal
};

/// Against another mesh; Dice on a 0.5 mm grid (open meshes capped flat).
Agreement compare_meshes(const Mesh& a, const Mesh& b);

/// Against label `label` of a mask: surfaces against the mask's 0.5 isosurface, Dice on the mask's grid.
/// Errors: the label does not occur.
Result<Agreement> compare_with_mask(const Mesh& mesh, const Volume& mask, int label, int frame = 0);

/// The label to use when none was named: the only one there is. Errors: none, or several (they are named).
Result<int> only_label(const Volume& mask, int frame = 0);

}  // namespace homolog
