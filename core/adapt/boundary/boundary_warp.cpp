#include "core/adapt/boundary/boundary_warp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/landmark_warp.h"
#include "core/placement/likely_similarity.h"

namespace homolog {

namespace {

/// Shares of the bounding-box diagonal: how far what is known reaches, how large a displacement may be, how far the
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

/// The typical parts of the displacement of an organ that is known to differ smoothly, at one diagonal of the
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
    Eigen::MatrixXd covariance = bumps(a, b);
    const Eigen::ArrayX3d from = (a.rowwise() - centre).array() / diagonal_mm;
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      const Eigen::RowVector3d to = (b.row(j) - centre) / diagonal_mm;
      const auto product = from.col(0) * to[0] + from.col(1) * to[1] + from.col(2) * to[2];
      covariance.col(j).array() +=
          diagonal_mm * diagonal_mm * (shift * shift + (stretch * stretch + bend * bend * product) * product);
    }
    return covariance;
  };
}

/// The displacement of `points`, told by what is known of it at some places: of each its length along directions.
class Regression {
 public:
  Regression(const Points& points, const Points& places, const Covariance& kernel)
      : among_(kernel(places, places)), towards_(kernel(points, places)) {}

  /// At one of the places: how long it is along `direction`, and the noise of that.
  void know(Eigen::Index place, const Eigen::RowVector3d& direction, double offset_mm, double noise_mm) {
    known_.push_back({place, direction, offset_mm, noise_mm});
  }
  void forget() { known_.clear(); }
  /// The displacement's mean at the points, n×3, mm.
  Points mean_mm() const {
    const Eigen::Index count = std::ssize(known_);
    std::vector<Eigen::Index> at;
    Points along(count, 3);
    Eigen::VectorXd offset_mm(count), noise_mm(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Known& one = known_[k];
      at.push_back(one.place);
      along.row(k) = one.direction;
      offset_mm[k] = one.offset_mm;
      noise_mm[k] = one.noise_mm;
    }
    Eigen::MatrixXd covariance = along * along.transpose();
    for (Eigen::Index k = 0; k < count; ++k) covariance.col(k).array() *= among_(at, at[k]).array();
    covariance.diagonal() += noise_mm.cwiseAbs2();
    const Eigen::VectorXd weights = covariance.llt().solve(offset_mm);
    Points pull = Points::Zero(among_.rows(), 3);
    for (Eigen::Index k = 0; k < count; ++k) pull.row(at[k]) += weights[k] * along.row(k);
    return towards_ * pull;
  }

 private:
  struct Known {
    Eigen::Index place;
    Eigen::RowVector3d direction;
    double offset_mm, noise_mm;
  };
  Eigen::MatrixXd among_, towards_;
  std::vector<Known> known_;
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
  Eigen::Index stride;  ///< every so many vertices look for it
  int rounds;
  std::optional<double> outlying;  ///< times the median distance: farther off, it is that of another part
  bool own_normals;                ///< the distance is known along the mesh's normals, else along the boundary's
};

/// The likeliest displacement of `placed`; the boundary is looked for from `start` on. `landmark_mm`: the noise of each
/// landmark.
WarpedReference warped_from(const Points& start, const std::shared_ptr<const Topology>& topology, const Points& placed,
                            const KnownMatches& landmarks, const VertexScalars& landmark_mm, const Look& look,
                            Target& target) {
  const Eigen::Index count = landmarks.from.rows(), stride = look.stride,
                     samples = (placed.rows() + stride - 1) / stride;
  Points places(count + samples, 3);
  places << landmarks.from, placed(Eigen::seqN(0, samples, stride), Eigen::all);
  Regression known(placed, places, look.kernel);
  Points warped = start;
  for (int round = 0; round < look.rounds; ++round) {
    const TargetPull there = target.nearest({topology, warped});
    const Points normals = look.own_normals ? vertex_normals({topology, warped}) : there.normals;
    std::vector<double> distances;
    for (Eigen::Index v = 0; v < placed.rows(); v += stride)
      if (there.weights[v] > 0) distances.push_back((there.targets.row(v) - warped.row(v)).norm());
    const double farthest =
        look.outlying ? *look.outlying * quantile(distances, 0.5) : std::numeric_limits<double>::infinity();
    known.forget();
    for (Eigen::Index k = 0; k < count; ++k)
      for (int axis = 0; axis < 3; ++axis)
        known.know(k, Eigen::RowVector3d::Unit(axis), landmarks.to(k, axis) - landmarks.from(k, axis), landmark_mm[k]);
    for (Eigen::Index sample = 0; sample < samples; ++sample) {
      const Eigen::Index v = sample * stride;
      if (there.weights[v] == 0 || (there.targets.row(v) - warped.row(v)).norm() > farthest) continue;
      const Eigen::RowVector3d normal = normals.row(v);
      known.know(count + sample, normal, (there.targets.row(v) - placed.row(v)).dot(normal), look.boundary_mm);
    }
    warped = placed + known.mean_mm();
  }
  return without_folds(*topology, placed, warped - placed);
}

}  // namespace

Points warp_to_boundary(const std::shared_ptr<const Topology>& topology, const Points& placed,
                        const KnownMatches& landmarks, double roundness, Target& target) {
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
  return warped_from(placed, topology, placed, landmarks, std::pow(few, 1.5) * landmarks.noise_mm, look, target).points;
}

Points warp_along_boundary(const Mesh& there, const Points& placed, const KnownMatches& landmarks, Target& target) {
  // A vertex may lie far from where it was placed. A direction that is a little off is then off by much, and those of a
  // label's boundary are, as its voxels are seen in them.
  const Look look{.kernel = quadratic_and_bumps(placed),
                  .boundary_mm = beside_these.boundary_noise * bounds_of(placed).diagonal().norm(),
                  .stride = 1 + (placed.rows() - 1) / most_samples_if_smooth,
                  .rounds = rounds_if_smooth,
                  .outlying = {},
                  .own_normals = true};
  WarpedReference warped =
      warped_from(there.points, there.topology, placed, landmarks, landmarks.noise_mm, look, target);
  return warped.folds || !warped.points.allFinite() ? there.points : std::move(warped.points);
}

}  // namespace homolog
