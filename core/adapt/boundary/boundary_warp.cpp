#include "core/adapt/boundary/boundary_warp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/statistics.h"
#include "core/placement/landmark_warp.h"
#include "core/placement/likely_similarity.h"

namespace homolog {

namespace {

/// Of the bounding-box diagonal: how far what is known reaches, how large a displacement may be, and how far the
/// nearest boundary may be off.
struct Shares {
  double reach, bump, boundary_noise;
};
/// Beside features, as bones have them, the nearest boundary is often that of another part.
constexpr Shares with_features{.reach = 0.3, .bump = 0.045, .boundary_noise = 0.015},
    if_round{.reach = 0.45, .bump = 0.3, .boundary_noise = 0.02};
constexpr int rounds = 8;
constexpr Eigen::Index most_samples = 260;
/// One of few landmarks carries a large part of the organ with it, also where it is off: below this many, each is
/// believed less.
constexpr double enough_landmarks = 8;
constexpr double outlying = 4;  // times the median distance: another part of the organ

/// What is known of the displacement: at each place its length along one direction.
struct Observations {
  Points at, along;
  Eigen::VectorXd offset_mm, noise_mm;

  explicit Observations(Eigen::Index most) : at(most, 3), along(most, 3), offset_mm(most), noise_mm(most) {}
  void add(const Eigen::RowVector3d& place, const Eigen::RowVector3d& direction, double offset, double noise) {
    at.row(count_) = place;
    along.row(count_) = direction;
    offset_mm[count_] = offset;
    noise_mm[count_++] = noise;
  }
  /// The displacement's mean at `points`, n×3.
  Points regress(const Points& points, const WarpKernel& kernel) const {
    const Points known = at.topRows(count_), ways = along.topRows(count_);
    Eigen::MatrixXd covariance = kernel(known, known).cwiseProduct(ways * ways.transpose());
    covariance.diagonal() += noise_mm.head(count_).cwiseAbs2();
    const Eigen::VectorXd weights = covariance.llt().solve(offset_mm.head(count_));
    return kernel(points, known) * (weights.asDiagonal() * ways);
  }

 private:
  Eigen::Index count_ = 0;
};

/// A displacement that reaches far carries far what landmarks are off by. So the noisier they are, the less of it:
/// `times` is their noise over that of a person who clicks with care.
Shares shares_of(double roundness, double times) {
  const auto between = [&](double featured, double round) { return featured + roundness * (round - featured); };
  return {between(with_features.reach, if_round.reach),
          between(with_features.bump, std::max(with_features.bump, if_round.bump / times)),
          between(with_features.boundary_noise, if_round.boundary_noise)};
}

}  // namespace

Points warp_to_boundary(const std::shared_ptr<const Topology>& topology, const Points& placed,
                        const KnownMatches& landmarks, double roundness, BoundarySearch& search) {
  const Eigen::Index count = landmarks.from.rows();
  if (count < fewest_placing_landmarks) return placed;
  const double diagonal_mm = bounds_of(placed).diagonal().norm();
  WarpLengths lengths = warp_lengths(diagonal_mm);
  const Shares shares = shares_of(roundness, landmarks.noise_mm.minCoeff() / lengths.noise_mm);
  lengths.reach_mm = shares.reach * diagonal_mm;
  lengths.bump_mm = shares.bump * diagonal_mm;
  const WarpKernel kernel(placed.colwise().mean(), lengths);
  const Eigen::Index stride = std::max<Eigen::Index>(1, placed.rows() / most_samples);
  const double few = std::max(1.0, enough_landmarks / static_cast<double>(count)),
               boundary_mm = shares.boundary_noise * diagonal_mm;
  const VertexScalars landmark_mm = std::pow(few, 1.5) * landmarks.noise_mm;
  Points warped = placed;
  for (int round = 0; round < rounds; ++round) {
    const BoundaryPull there = search.nearest({topology, warped});
    std::vector<double> distances;
    for (Eigen::Index v = 0; v < placed.rows(); v += stride)
      if (there.weights[v] > 0) distances.push_back((there.targets.row(v) - warped.row(v)).norm());
    const double farthest = outlying * quantile(distances, 0.5);
    Observations known(3 * count + std::ssize(distances));
    for (Eigen::Index k = 0; k < count; ++k)
      for (int axis = 0; axis < 3; ++axis)
        known.add(landmarks.from.row(k), Eigen::RowVector3d::Unit(axis),
                  landmarks.to(k, axis) - landmarks.from(k, axis), landmark_mm[k]);
    for (Eigen::Index v = 0; v < placed.rows(); v += stride) {
      if (there.weights[v] == 0 || (there.targets.row(v) - warped.row(v)).norm() > farthest) continue;
      const Eigen::RowVector3d normal = there.normals.row(v);
      known.add(placed.row(v), normal, (there.targets.row(v) - placed.row(v)).dot(normal), boundary_mm);
    }
    warped = placed + known.regress(placed, kernel);
  }
  return without_folds(*topology, placed, warped - placed).points;
}

}  // namespace homolog
