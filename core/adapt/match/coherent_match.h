#pragma once

#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// How freely a match lets a shape vary, and how sure it is of what it sees.
struct MatchFreedom {
  double bend_share;  ///< typical smooth displacement, as a share of the shape's radius (root mean square)
  double together;    ///< samples that count as one observation: neighbours see the same
  double facing;      ///< what a difference of normals counts: 0 nothing
};
inline constexpr MatchFreedom loose_match{.bend_share = 0.3, .together = 1, .facing = 2},
    close_match{.bend_share = 0.1, .together = 10, .facing = 4};

/// Places that correspond: where a placed shape has them and where they belong, k×3 each, LPS mm, row by row. `trust`:
/// of each, 0 … 1.
struct KnownMatches {
  Points from, to;
  VertexScalars trust;
};

/// Matches a placed shape with a surface as a whole, by probabilities. Each sample of one may belong to any of the
/// other: the likelier the nearer it lies and the more its normal looks the same way. This holds in both directions,
/// and what has no counterpart may belong to none. The displacement of space that is most likely under these
/// probabilities (Gaussian-process regression on a smooth kernel) gives the next ones, while the distance that counts
/// as near falls. So differences of the whole (a twist, another length of a shaft) are found before details. A search
/// for nearest points slides past them. [Myronenko and Song 2010, Coherent Point Drift; Hirose 2021, Bayesian coherent
/// point drift; normals and both directions added.]
/// All lengths are shares of the shapes' sizes. One thread, no random numbers.
class CoherentMatch {
 public:
  /// `reference`: n×3 in the template's own frame; it decides which of its vertices are sampled. `placed`: the template
  /// under its similarity, LPS mm. `surface`: what it is matched with, outward oriented, LPS mm.
  CoherentMatch(const Points& reference, const Mesh& placed, const Mesh& surface);

  /// The placed template displaced, n×3, LPS mm.
  Points match(const MatchFreedom& freedom, const KnownMatches& known) const;

 private:
  /// Points with their normals and the area that each stands for.
  struct Samples {
    Points points, normals;
    Eigen::VectorXf area_mm2;
  };
  /// Where the samples of the shape are drawn to, and how much each is believed (area of both directions, mm²).
  struct Drawn {
    Points targets;
    VertexScalars weights;
  };
  static Samples samples_of(const Mesh& mesh, const std::vector<Eigen::Index>& at);
  Drawn drawn(const Points& own, const Points& normals, double near_mm, double facing) const;
  Eigen::MatrixXd kernel(const Points& a, const Points& b, const MatchFreedom& freedom) const;
  Eigen::MatrixXd basis(const Points& at, const MatchFreedom& freedom) const;

  Mesh placed_;
  std::vector<Eigen::Index> own_at_;  ///< vertices of the template that are sampled
  Points nodes_;                      ///< where the displacement is represented
  Samples own_, there_;
  Eigen::RowVector3d centre_;
  double radius_mm_, size_mm_;  ///< root mean square from the centre; root of the surface's area
};

}  // namespace homolog
