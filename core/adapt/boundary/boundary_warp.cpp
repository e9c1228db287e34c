#include "core/adapt/boundary/boundary_warp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/statistics.h"
#include "core/mesh/mesh_quality.h"
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
constexpr Eigen::Index about_samples = 260;
/// One of few landmarks carries a large part of the organ with it, also where it is off: below this many, each is
/// believed less.
constexpr double enough_landmarks = 8;
constexpr double outlying = 4;  ///< times the median distance: another part of the organ

WarpLengths lengths_of(const Shares& shares, double diagonal_mm) {
  return {shares.reach * diagonal_mm, shares.bump * diagonal_mm, warp_lengths(diagonal_mm).noise_mm};
}

/// Where an organ is known to differ smoothly: what is typical of the parts of its displacement, at one diagonal of the
/// bounding box from its centre. With so much shift, stretch and bend any quadratic map is nearly free.
constexpr double shift = 0.1, stretch = 0.25, bend = 0.9;
constexpr Shares beside_these{.reach = 0.13, .bump = 0.02, .boundary_noise = 0.007};
constexpr int rounds_if_smooth = 3;  ///< it begins on the boundary
constexpr Eigen::Index most_samples_if_smooth = 1250;

/// The covariance of each coordinate of a displacement at two places, in mm².
using Covariance = std::function<Eigen::MatrixXd(const Points&, const Points&)>;

/// A quadratic map, so that an organ grows, is sheared, bends and twists as a whole, and bumps.
Covariance quadratic_and_bumps(const Points& placed) {
  const Eigen::RowVector3d centre = placed.colwise().mean();
  const double diagonal_mm = bounds_of(placed).diagonal().norm();
  const WarpKernel bumps(centre, lengths_of(beside_these, diagonal_mm));
  return [=](const Points& a, const Points& b) -> Eigen::MatrixXd {
    const Points from = (a.rowwise() - centre) / diagonal_mm, to = (b.rowwise() - centre) / diagonal_mm;
    const Eigen::ArrayXXd products = (from * to.transpose()).array(),
                          quadratic = shift * shift + stretch * stretch * products + bend * bend * products.square();
    return bumps(a, b) + (diagonal_mm * diagonal_mm * quadratic).matrix();
  };
}

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
  Points regress(const Points& points, const Covariance& kernel) const {
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
  Covariance kernel;
  double boundary_mm;   ///< how far off the nearest boundary may be
  Eigen::Index stride;  ///< of the vertices that look for it
  int rounds;
  std::optional<double> outlying;  ///< times the median distance: farther off, it is that of another part
  bool own_normals;                ///< the distance is known along the mesh's normals, else along the boundary's
};

/// The likeliest displacement of `placed`; the boundary is looked for from `start` on. `landmark_mm`: the noise of each
/// landmark.
WarpedReference warped_from(const Points& start, const std::shared_ptr<const Topology>& topology, const Points& placed,
                            const KnownMatches& landmarks, const VertexScalars& landmark_mm, const Look& look,
                            BoundarySearch& search) {
  const Eigen::Index count = landmarks.from.rows(), stride = look.stride;
  Points warped = start;
  for (int round = 0; round < look.rounds; ++round) {
    const BoundaryPull there = search.nearest({topology, warped});
    const Points normals = look.own_normals ? vertex_normals({topology, warped}) : there.normals;
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
      const Eigen::RowVector3d normal = normals.row(v);
      known.add(placed.row(v), normal, (there.targets.row(v) - placed.row(v)).dot(normal), look.boundary_mm);
    }
    warped = placed + known.regress(placed, look.kernel);
  }
  return without_folds(*topology, placed, warped - placed);
}

}  // namespace

Points warp_to_boundary(const std::shared_ptr<const Topology>& topology, const Points& placed,
                        const KnownMatches& landmarks, double roundness, BoundarySearch& search) {
  const Eigen::Index count = landmarks.from.rows();
  if (count < fewest_placing_landmarks) return placed;
  const double diagonal_mm = bounds_of(placed).diagonal().norm(), clicked_mm = warp_lengths(diagonal_mm).noise_mm,
               few = std::max(1.0, enough_landmarks / static_cast<double>(count));
  const Shares shares = shares_of(roundness, landmarks.noise_mm.minCoeff() / clicked_mm);
  const Look look{.kernel = WarpKernel(placed.colwise().mean(), lengths_of(shares, diagonal_mm)),
                  .boundary_mm = shares.boundary_noise * diagonal_mm,
                  .stride = std::max<Eigen::Index>(1, placed.rows() / about_samples),
                  .rounds = rounds,
                  .outlying = outlying,
                  .own_normals = false};
  return warped_from(placed, topology, placed, landmarks, std::pow(few, 1.5) * landmarks.noise_mm, look, search).points;
}

Points warp_along_boundary(const Mesh& there, const Points& placed, const KnownMatches& landmarks,
                           BoundarySearch& search) {
  // A vertex may lie far from where it was placed. A direction that is a little off is then off by much, and those of a
  // label's boundary are, as its voxels are seen in them.
  const Look look{.kernel = quadratic_and_bumps(placed),
                  .boundary_mm = beside_these.boundary_noise * bounds_of(placed).diagonal().norm(),
                  .stride = 1 + (placed.rows() - 1) / most_samples_if_smooth,
                  .rounds = rounds_if_smooth,
                  .outlying = {},
                  .own_normals = true};
  WarpedReference warped =
      warped_from(there.points, there.topology, placed, landmarks, landmarks.noise_mm, look, search);
  return warped.folds || !warped.points.allFinite() ? there.points : std::move(warped.points);
}

}  // namespace homolog
