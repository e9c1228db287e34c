#pragma once

#include <vector>

#include "core/adapt/match/smooth_displacement.h"
#include "core/adapt/match/surface_samples.h"
#include "core/mesh/topology.h"
#include "core/placement/known_matches.h"

namespace homolog {

/// How freely a match lets a shape vary, and how sure it is of what it sees.
struct MatchFreedom {
  double bend_share;  ///< typical smooth displacement, as a share of the shape's radius (root mean square)
  double together;    ///< samples that count as one observation: neighbours see the same
  double facing;      ///< how much a difference of normals counts: 0 nothing
};
inline constexpr MatchFreedom loose_match{.bend_share = 0.3, .together = 1, .facing = 2},
    close_match{.bend_share = 0.2, .together = 10, .facing = 4};

/// Matches a placed shape with a surface as a whole, by probabilities. Each sample of one may belong to any of the
/// other: the likelier the nearer it lies and the more its normal looks the same way. This holds in both directions,
/// and what has no counterpart may belong to none. The displacement of space that is most likely under these
/// probabilities (Gaussian-process regression on a smooth kernel) gives the next ones, while the distance that counts
/// as near falls. So differences of the whole (a twist, another length of a shaft) are found before details. A search
/// for nearest points slides past them. [Myronenko and Song 2010, Coherent Point Drift; Hirose 2021, Bayesian coherent
/// point drift; normals and both directions added.]
/// The shape is displaced to the surface, and the surface to the shape. The mean of the first displacement and of the
/// second one turned round depends far less on which shape is the template [Christensen and Johnson 2001, inverse
/// consistency].
/// All lengths are shares of the shapes' sizes. One thread, no random numbers.
class CoherentMatch {
 public:
  /// `template_points`: n×3 in the template's own frame; they decide which of its vertices are sampled. `placed`: the
  /// template under its similarity, LPS mm. `surface`: what it is matched with, outward oriented, LPS mm.
  CoherentMatch(const Points& template_points, const Mesh& placed, const Mesh& surface);

  /// The placed template displaced, n×3, LPS mm: by what takes it to the surface, and against what takes the surface to
  /// it.
  struct Ways {
    Points forth, back;
    Points mean() const { return (forth + back) / 2; }
  };
  /// Not finite where no displacement could be found, as of a shape without extent.
  Ways match(const MatchFreedom& freedom, const KnownMatches& known) const;

 private:
  /// How finely a surface is sampled while it matches: few samples, evenly spread, where it is displaced, and more
  /// where it stays.
  struct Side {
    SurfaceSamples moved, still;
  };
  using Sides = std::vector<Side>;  ///< coarse ones first
  static Sides sides_of(const Mesh& mesh, const Points& spread_as);
  SmoothDisplacement::Coefficients matching(const Sides& own, const Sides& there,
                                            const SmoothDisplacement& displacement, const MatchFreedom& freedom,
                                            const KnownMatches& known) const;

  Points placed_;
  Points nodes_;  ///< the nodes of the displacements
  Sides own_, there_;
  Eigen::RowVector3d centre_;
  double radius_mm_, size_mm_;  ///< root mean square from the centre; root of the surface's area
};

}  // namespace homolog
