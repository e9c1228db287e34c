#pragma once

#include <optional>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/placement/likely_similarity.h"
#include "core/template/template.h"

namespace homolog {

/// Named places: where the template has them (its own frame) and where the organ has them, k×3 each, row by row.
struct KnownPlaces {
  Points own, there;
};

/// A similarity, and how well it does.
struct Placed {
  Similarity placement;
  double distance_mm = 0;  ///< root mean square of closest distances between samples of both surfaces
  double cost = 0;         ///< minus the logarithm of its likelihood, but for a constant
  VertexScalars trust;     ///< trust in each named place, 0 (a blunder) … 1
};

/// The likelihood of a template's placement on a boundary: how far samples of each lie from the other surface, where
/// named places lie, and what is known before. The template stays where it is, so that its search tree is made once.
class ClosestPoints {
 public:
  /// Both outlive this. `partial`: either surface may lack what the other has, so no distance counts for more than a
  /// missing place does, and those that are missing in the boundary count less.
  ClosestPoints(const Template& the_template, const Boundary& boundary, bool partial = false);
  /// Only some places on the organ's surface are known (k×3, LPS mm). It weighs how far they lie from the template.
  ClosestPoints(const Template& the_template, const Points& places);

  /// The likeliest placement near `start`, by Gauss-Newton steps until one is shorter than `rest` times the organ's
  /// size; it ends before one that would turn it away from the prior's rotation by more than `most_turn` (radians). A
  /// named place is what a person knows, or with a small probability a blunder.
  Placed refined(const Similarity& start, double most_turn, const PlacementPrior& prior, const KnownPlaces& places,
                 double rest, int most_steps = 100) const;

 private:
  /// A movement of all placed points: a turn about the template's centre (radians), a shift (mm), a growth (of the
  /// logarithm of the scale).
  using Step = Eigen::Matrix<double, 7, 1>;
  struct State;
  struct System;
  State look(const Similarity& placement, const PlacementPrior& prior, const KnownPlaces& places,
             const std::vector<std::int32_t>& likely_faces) const;
  System system_at(const State& state, const PlacementPrior& prior, const KnownPlaces& places) const;
  Similarity moved(const Similarity& placement, const Step& way) const;
  void weigh(const Points& there);

  const Boundary* boundary_ = nullptr;        ///< null: some places alone are known
  std::optional<SurfaceSearch> on_boundary_;  ///< the search on the boundary
  SurfaceSearch on_template_;
  std::vector<Vec3> own_, there_;
  double diagonal_mm_, sample_weight_;
  bool partial_ = false;
};

}  // namespace homolog
