#pragma once

#include <optional>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

// What is given here is checked: a mesh that check_mesh refuses, and a frame or a volume that check_frame_of refuses,
// are an error of a Result. Where a function returns none it throws std::invalid_argument.

/// How well two surfaces agree. Distances are exact ones from points of each surface to the other surface, in mm, the
/// points at the centres of equal parts of every face, none larger than 1/20,000 of the surface, weighted by area.
struct Agreement {
  double dice = 0;
  double assd_mm = 0;                                   ///< mean over both surfaces' area together
  double hd95_mm = 0;                                   ///< the larger of the two directions' 95th percentiles
  double hausdorff_mm = 0;                              ///< the largest either way, vertices looked at too
  std::optional<double> vertex_mean_mm, vertex_max_mm;  ///< between equal indices, where topologies are equal
};

/// Distances from points of one surface, as for Agreement, to another, in mm.
struct SurfaceDistance {
  double mean_mm = 0, p95_mm = 0, max_mm = 0;
};
SurfaceDistance surface_distance(const Mesh& from, const Mesh& to);

/// Against another mesh; Dice on a 0.5 mm grid, open meshes capped flat (coarser by powers of 2 beyond 2³¹ voxels,
/// finer where both meshes together are less than 64 mm long; 1 where both are too flat to hold a voxel).
Agreement compare_meshes(const Mesh& a, const Mesh& b);

/// `assd_mm` of compare_meshes alone; NaN where one of them has no topology.
double mean_surface_distance_mm(const Mesh& a, const Mesh& b);

/// Against label `label` of a mask: surfaces against the mask's 0.5 isosurface, Dice on the mask's grid.
/// Errors: the label does not occur.
Result<Agreement> compare_with_mask(const Mesh& mesh, const Volume& mask, int label, int frame = 0);

/// Dice of the mesh and label `label` on the mask's grid alone.
double dice_with_mask(const Mesh& mesh, const Volume& mask, int label, int frame = 0);

/// The label to use when none was named: the only one there is. Errors: none, or several (they are named).
Result<int> only_label(const Volume& mask, int frame = 0);

}  // namespace homolog
