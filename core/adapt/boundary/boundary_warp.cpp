#include "core/adapt/boundary/boundary_warp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

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
/// Where the organ is known to differ smoothly, and no landmark holds it.
constexpr Shares if_smooth{.reach = 0.6, .bump = 0.1, .boundary_noise = 0.012};
constexpr int rounds = 8;
constexpr Eigen::Index about_samples = 260, most_samples_alone = 1250;
/// One of few landmarks carries a large part of the organ with it, also where it is off: below this many, each is
/// believed less.
constexpr double enough_landmarks = 8;
constexpr double outlying = 4;  ///< times the median distance: another part of the organ

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

/// How a warp looks at the boundary.
struct Look {
  Shares shares;
  Eigen::Index stride;             ///< of the vertices that look for it
  std::optional<double> outlying;  ///< times the median distance: farther off, it is that of another part
};

/// The likeliest displacement of `placed`; the boundary is looked for from `start` on. `landmark_mm`: the noise of each
/// landmark.
WarpedReference warped_from(const Points& start, const std::shared_ptr<const Topology>& topology, const Points& placed,
                            const KnownMatches& landmarks, const VertexScalars& landmark_mm, const Look& look,
                            BoundarySearch& search) {
  const double diagonal_mm = bounds_of(placed).diagonal().norm(),
               boundary_mm = look.shares.boundary_noise * diagonal_mm;
  WarpLengths lengths = warp_lengths(diagonal_mm);
  lengths.reach_mm = look.shares.reach * diagonal_mm;
  lengths.bump_mm = look.shares.bump * diagonal_mm;
  const WarpKernel kernel(placed.colwise().mean(), lengths);
  const Eigen::Index count = landmarks.from.rows(), stride = look.stride;
  Points warped = start;
  for (int round = 0; round < rounds; ++round) {
    const BoundaryPull there = search.nearest({topology, warped});
    std::vector<double> distances;
    for (Eigen::Index v = 0; v < placed.rows(); v += stride)
      if (there.weights[v] > 0) distances.push_back((there.targets.row(v) - warped.row(v)).norm());
    const double farthest =
        look.outlying ? *look.outlying * quantile(distances, 0.5) : std::numeric_limits<double>::infinity();
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
  return without_folds(*topology, placed, warped - placed);
}

}  // namespace

Points warp_to_boundary(const std::shared_ptr<const Topology>& topology, const Points& placed,
                        const KnownMatches& landmarks, double roundness, BoundarySearch& search) {
  const Eigen::Index count = landmarks.from.rows();
  if (count < fewest_placing_landmarks) return placed;
  const double clicked_mm = warp_lengths(bounds_of(placed).diagonal().norm()).noise_mm,
               few = std::max(1.0, enough_landmarks / static_cast<double>(count));
  const Look look{shares_of(roundness, landmarks.noise_mm.minCoeff() / clicked_mm),
                  std::max<Eigen::Index>(1, placed.rows() / about_samples), outlying};
  return warped_from(placed, topology, placed, landmarks, std::pow(few, 1.5) * landmarks.noise_mm, look, search).points;
}

Points warp_along_boundary(const Mesh& there, const Points& placed, BoundarySearch& search) {
  const Look look{if_smooth, 1 + (placed.rows() - 1) / most_samples_alone, {}};
  const KnownMatches none{Points(0, 3), Points(0, 3), {}};
  WarpedReference warped = warped_from(there.points, there.topology, placed, none, {}, look, search);
  return warped.folds || !warped.points.allFinite() ? there.points : std::move(warped.points);
}

}  // namespace homolog
