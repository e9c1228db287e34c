#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/deform/volume_energy.h"

namespace homolog {

/// Springs that hold points of the outside: weak ones to where they belong, strong ones across to the surface.
struct Springs {
  std::vector<Eigen::Index> points;
  Points places, feet, normals;  ///< a row for each of `points`: where it belongs; a place on the surface near to it
  double length_mm = 1;          ///< the length at which a spring weighs about as much as an element

  double along = 2, across = 100;  ///< how strong they are

  double value(const Points& x, Points* gradient) const;  ///< adds to the gradient
};

/// Finds where some points lie with the least energy. Elements that are turned over at first are pulled back round by
/// round, as epsilon falls [volume_energy.h]. Source: L-BFGS [Nocedal 1980].
class Minimiser {
 public:
  using Guess = std::function<Points(const Points&)>;

  /// `moving`: which points move. `guess`: the inverse of about the second derivatives times a slope (a row for each of
  /// these). Its arguments have to outlive it.
  Minimiser(const VolumeEnergy& energy, const Springs& springs, std::span<const Eigen::Index> moving, Guess guess)
      : energy_(energy), springs_(springs), moving_(moving), guess_(std::move(guess)) {}

  /// False where it was cancelled.
  bool run(Points& points, int most_rounds, Progress* progress) const;

 private:
  double value(const Points& points, double epsilon, Points* gradient) const;
  Eigen::VectorXd slope_of(const Points& gradient) const;
  Eigen::VectorXd guessed(const Eigen::VectorXd& slope) const;
  bool descend(Points& points, double epsilon, Progress* progress) const;

  const VolumeEnergy& energy_;
  const Springs& springs_;
  std::span<const Eigen::Index> moving_;
  Guess guess_;
};

}  // namespace homolog
