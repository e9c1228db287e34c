#pragma once

#include <optional>
#include <vector>

#include "core/adapt/ways/fit_context.h"

namespace homolog {

/// Ways of a template onto the boundary of a whole organ: from where it is placed, and from matches of it with the
/// boundary as a whole. It keeps the plain way, the mean of those from matches, or a mean of both.
class WholeWays {
 public:
  explicit WholeWays(const FitContext& fit) : fit_(fit) {}

  /// Goes them all. `start`: the template as placed or, with landmarks, warped (n×3, LPS mm). `match`: also those from
  /// matches.
  Result<void> go(const Points& start, bool match);
  /// Returns the way that is kept of them.
  Result<Adapting> kept();

  /// All that were gone, the plain one first.
  const std::vector<Adapted>& gone() const { return ways_; }
  /// How much a smooth warp decided of what is kept, of a round organ: 0 … roundness.
  double smooth() const { return smooth_; }

 private:
  /// The beginning of a way.
  struct Start {
    Points points;         ///< n×3, LPS mm
    bool matched = false;  ///< it was matched with the boundary as a whole, so that it is near and its own reference
  };
  std::vector<Start> starts(const Points& start, bool match) const;
  Result<Adapted> from(const Start& start);
  /// Whether a smooth displacement alone takes the template to the boundary: 1 where the last match lies on it, 0 where
  /// the organ has a shape that no smooth displacement gives.
  double differs_smoothly() const;
  /// The mean of the ways that lie on the boundary, n×3, those of less energy counting far more. The plain way is
  /// weighed by `plain_counts`; with landmarks the others by how far they are believed, else the mean is judged. None
  /// where no way counts.
  std::optional<Points> mean_way(double plain_counts) const;

  FitContext fit_;
  double smooth_ = 0;
  Points last_match_;  ///< n×3; empty where there was none
  std::vector<Adapted> ways_;
};

}  // namespace homolog
