#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/repair/mesh_repair.h"
#include "core/template_making/mask_template.h"

namespace homolog {

struct MeshTemplateOptions {
  int vertices = 2500;
  /// automatic: a surface of up to 16 tunnels keeps them; of one with more, narrow ones are filled.
  GenusRule genus;
  std::optional<double> closing_mm, opening_mm;  ///< they act as on a label; where one is given the surface is rebuilt
  /// Holes whose rim is longer stay open, as rims of the template. A share of the diagonal; negative: all stay.
  double longest_rim_share = small_rim_share;
};

/// A surface that was made anew from voxels.
struct Rebuilt {
  double voxel_mm = 0, wall_mm = 0;  ///< size of the voxels; by how much thin walls were made thicker
  int genus_before = 0;              ///< the surface's genus
  double closing_mm = 0, opening_mm = 0;
};

struct MeshTemplate {
  /// One component, numbered breadth-first, in the given mesh's frame. Closed where the surface has no long rim.
  Mesh mesh;
  SurfaceDistance to_mesh, from_mesh;  ///< distances from the template to the surface as it was mended, and back
  MendedFaults mended;
  std::optional<Rebuilt> rebuilt;
  std::vector<std::string> warnings;  ///< each a sentence on a part that was mended, left out or rebuilt
};

/// A reference mesh from an existing surface. The surface is mended [mesh_repair.h], its largest part is taken, small
/// holes are closed flat, and `vertices` are spread evenly over it. Long rims stay, with vertices spread along them. A
/// surface that is riddled with tunnels, or of which only a wreck would come, is rebuilt: the largest part with its
/// neighbouring_parts as voxels [solid_voxels.h], walls too thin for the mesh made thicker, and meshed as a label is
/// [mask_template.h]. So is one whose tunnels are to be cut. Errors: no faces; fewer tunnels than asked for; a surface
/// with a long rim that would have to be rebuilt, since voxels would close it; cancelled.
Result<MeshTemplate> make_mesh_template(const MeshFile& surface, const MeshTemplateOptions& options,
                                        Progress* progress = nullptr);

/// The same surface with `vertices` spread evenly [remesh.h], along its rims too, numbered breadth-first. The few faces
/// that meet others, are turned or flat after that are smoothed, and leave the surface a little.
Mesh spread_over(const Mesh& surface, int vertices, Progress* progress = nullptr);

}  // namespace homolog
