#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/placement/known_matches.h"
#include "core/template/template.h"

namespace homolog {

/// A landmark on one side of an organ, and what it tells of the other side.
struct MirroredLandmark {
  Eigen::Index of;     ///< which of the landmarks that both name, in the template's order
  SurfacePoint place;  ///< on the template: where its mirror image lies
  Vec3 there;          ///< on the organ, LPS mm: where the mirror image of the organ's landmark lies
};

/// Returns the other side's landmarks of an organ that is nearly symmetric, by its template and by its boundary
/// [mirror_symmetry.h]. One is left out where a landmark lies near, as those do that lie in the plane of symmetry. Any
/// other organ has none. `landmarks`: the organ's, by name; `trust`: of those that the template has too, in its order,
/// 0 to 1: one that is hardly believed counts for nothing. `placement`: of the template.
std::vector<MirroredLandmark> mirrored_landmarks(const Template& the_template, const Boundary& boundary,
                                                 const std::map<std::string, Vec3>& landmarks,
                                                 const VertexScalars& trust, const Similarity& placement);

/// Adds them to what is known. `placed`: the template under its similarity, LPS mm. No organ is quite symmetric, so
/// that a mirrored landmark is noisier than the one it is of.
void add_mirrored(const std::vector<MirroredLandmark>& mirrored, const Mesh& placed, KnownMatches& known);

}  // namespace homolog
