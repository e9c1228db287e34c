#pragma once

#include <memory>
#include <vector>

#include "core/mesh/geometry/surface_search.h"

namespace homolog {

/// The place of each vertex's mirror image on the same surface: which places of an organ that is symmetric in
/// itself, as a vertebra, are each other's counterparts.
struct SelfMirror {
  std::shared_ptr<const Topology> topology;
  std::vector<SurfacePoint> counterparts;  ///< each vertex's counterpart
  double off_mm = 0;                       ///< root mean square: how far the mirror images lie off the surface
};

/// Pairs the vertices of a surface (the mean of shapes in correspondence, mm) across the plane in which it is nearly
/// its own mirror image [mirror_symmetry.h], looked for from the sagittal plane through the middle. Errors: a surface
/// that is not symmetric in itself.
Result<SelfMirror> self_mirror(const Mesh& mean);

/// The mirror image of a shape (n×3, mm) in its own numbering: vertex i lies where the image of i's counterpart does.
/// It is turned over x, so that it has to be aligned. A shape that is symmetric comes back turned and no more.
Points mirrored_in_itself(const SelfMirror& mirror, const Points& shape);

}  // namespace homolog
