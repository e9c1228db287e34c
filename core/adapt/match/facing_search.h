#pragma once

#include "core/adapt/force.h"
#include "core/adapt/match/surface_samples.h"

namespace homolog {

/// Looks for the places where an organ faces as the template does. A tip, a crest or the top of a condyle is where a
/// surface faces some way. Directions count after each region of the template has turned as its shape did, so that a
/// twisted shaft misleads none. Where the organ is flat or round, they tell little, and little pulls.
class FacingSearch {
 public:
  /// `surface`: LPS mm, outward oriented; `vertices`: of the meshes to come, which decides the number of samples.
  FacingSearch(const Mesh& surface, Eigen::Index vertices);

  /// The places to which the vertices of `mesh`, which lies on the surface or near it, are drawn. `placed`: the
  /// template under its similarity, of the same topology; both LPS mm. The surer a direction tells a place, the larger
  /// the weight: about 0.3 in a plane, where a vertex stays, up to 10 on a sharp edge.
  TargetPull pull(const Mesh& placed, const Mesh& mesh) const;

  /// The length over which vertices should slide together.
  double stiffness_mm() const;

 private:
  double size_mm_;  ///< root of the surface's area
  double near_mm_;  ///< how far a place may be off
  SurfaceSamples there_;
};

}  // namespace homolog
