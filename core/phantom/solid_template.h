#pragma once

#include <string>
#include <vector>

#include "core/phantom/deformation.h"
#include "core/phantom/phantom.h"

namespace homolog::phantom {

/// A solid as in implicit.h.
using Solid = double (*)(const Vec3& p);

/// A landmark of a mean shape: the vertex nearest to `near` (in the solid's frame).
struct NamedPlace {
  std::string name;
  Vec3 near;
};

/// The even mesh of a solid's surface, and where the mesh's origin lies in the solid's frame.
struct SolidTemplate {
  MeshFile mesh;   ///< centred at the mean of its vertices; factors 1; numbered breadth first from the first place
  Vec3 centre_mm;  ///< p_solid = p_mesh + centre_mm
};

/// Meshes the surface of `solid`, which lies inside `box`, with `vertices` vertices. `places` must not be empty.
SolidTemplate template_of(Solid solid, const Box& box, int vertices, const std::vector<NamedPlace>& places);

/// The vertebra of spine.h, meshed.
const SolidTemplate& mean_vertebra();

/// The mean shape and its landmarks carried to a subject.
MeshFile deformed(const MeshFile& mean, const Deformation& deformation);

/// The subject that a deformation makes of the mean shape, seen in `image`: label map, truth and landmarks.
PhantomSubject solid_subject(const SolidTemplate& mean, const Deformation& deformation, Volume image);

}  // namespace homolog::phantom
