#include "core/adapt/match/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

using Eigen::Index;
using Rows6f = Eigen::Matrix<float, Eigen::Dynamic, 6>;

constexpr Index most_candidates = 40000;  ///< at most so many vertices are spread
constexpr double unmatched = 0.01;        ///< share of a full match's weight: belonging to none
constexpr double unlocated = 0.0001;      ///< the same of a place that is located for itself
constexpr float least_exponent = -16;     ///< smaller probabilities are lost in the sums

/// Half the width within which a probability is not lost, in units of the distance that counts as near.
const float full_reach = std::sqrt(-2 * least_exponent);
/// The same where only what lies around counts.
constexpr float smoothing_reach = 3, locating_reach = 2;
/// Share of the square of the distance that counts as near: no place is located finer.
constexpr float finest_variance = 0.01F;
constexpr float least_known = 0.2F;  ///< below, several places are as likely or none is

struct Rows {
  Index first, count;
};

/// The rows whose value lies within `reach` of `middle`. `values` ascend.
Rows rows_within(const Eigen::Ref<const Eigen::VectorXf>& values, float middle, float reach = full_reach) {
  const auto from = std::lower_bound(values.begin(), values.end(), middle - reach);
  const auto to = std::upper_bound(from, values.end(), middle + reach);
  return {from - values.begin(), to - from};
}

/// Each place's share of the area. The denser they lie, the less each stands for. A count of what lies nearest to
/// each would hang on ties. `places` in units of their mean spacing.
Eigen::VectorXf area_shares(const Eigen::MatrixX3f& places, Index along) {
  Eigen::VectorXf shares(places.rows());
  for (Index i = 0; i < places.rows(); ++i) {
    const auto [first, count] = rows_within(places.col(along), places(i, along));
    const auto away = places.middleRows(first, count).rowwise() - places.row(i);
    shares[i] = 1 / (away.rowwise().squaredNorm().array() / -2).max(least_exponent).exp().sum();
  }
  return shares / shares.sum();
}

/// Places from `centre` and normals as rows: the exponent of a pair's probability is minus half their squared distance.
Rows6f joint_rows(const Points& places, const Points& normals, const Eigen::RowVector3d& centre, double near_mm,
                  double facing) {
  Rows6f rows(places.rows(), 6);
  rows.leftCols<3>() = ((places.rowwise() - centre) / near_mm).cast<float>();
  rows.rightCols<3>() = (facing * normals).cast<float>();
  return rows;
}

}  // namespace

std::vector<Index> stepped_vertices(Index vertices, Index count) {
  std::vector<Index> picked;
  for (Index v = 0; v < vertices; v += 1 + vertices / count) picked.push_back(v);
  return picked;
}

std::vector<Index> spread_vertices(const Points& points, Index count) {
  // Squared distances count in whole steps, so that hardly a pick hangs on the last bit of a coordinate.
  constexpr double steps = 1e4;  // in the squared radius
  const std::vector<Index> candidates = stepped_vertices(points.rows(), most_candidates);
  const Points places = points(candidates, Eigen::all);
  const Eigen::RowVector3d centre = places.colwise().mean();
  const double radius2 = (places.rowwise() - centre).rowwise().squaredNorm().mean();
  std::vector<Index> picked;
  const Eigen::ArrayXd x = places.col(0), y = places.col(1), z = places.col(2);
  Eigen::ArrayXd away = Eigen::ArrayXd::Constant(places.rows(), std::numeric_limits<double>::infinity());
  for (Index next = 0; std::ssize(picked) < std::min(count, places.rows()) && away[next] > 0; away.maxCoeff(&next)) {
    picked.push_back(candidates[next]);
    const auto from_next2 = (x - x[next]).square() + ((y - y[next]).square() + (z - z[next]).square());
    away = away.min((from_next2 * (steps / radius2)).floor());
  }
  return picked;
}

SurfaceSamples samples_of(const Mesh& mesh, const Points& normals, std::vector<Index> vertices) {
  Index along = 0;
  bounds_of(mesh.points).sizes().maxCoeff(&along);
  std::ranges::stable_sort(vertices, {}, [&](Index v) { return mesh.points(v, along); });
  SurfaceSamples samples{mesh.points(vertices, Eigen::all), normals(vertices, Eigen::all), {}, along, {}};
  const double area_mm2 = surface_area_mm2(mesh);
  const double spacing_mm = std::sqrt(area_mm2 / static_cast<double>(vertices.size()));
  const Eigen::RowVector3d centre = samples.points.colwise().mean();
  const Eigen::MatrixX3f places = ((samples.points.rowwise() - centre) / spacing_mm).cast<float>();
  samples.area_mm2 = static_cast<float>(area_mm2) * area_shares(places, along);
  samples.vertices = std::move(vertices);
  return samples;
}

Points smooth_normals(const SurfaceSamples& samples, double size_mm) {
  const Eigen::RowVector3d centre = samples.points.colwise().mean();
  const Eigen::MatrixX3f places = ((samples.points.rowwise() - centre) / size_mm).cast<float>(),
                         normals = samples.normals.cast<float>();
  Points smooth = samples.normals;
  in_parallel(places.rows(), [&](Index from, Index to) {
    for (Index i = from; i < to; ++i) {
      const auto [first, count] = rows_within(places.col(samples.along), places(i, samples.along), smoothing_reach);
      const auto around = normals.middleRows(first, count);
      const Eigen::ArrayXf apart2 = (places.middleRows(first, count).rowwise() - places.row(i)).rowwise().squaredNorm();
      const Eigen::ArrayXf same_side = (around * normals.row(i).transpose()).array().max(0);
      const Eigen::ArrayXf close = same_side * (apart2 / -2).max(least_exponent).exp();
      const Eigen::RowVector3f sum =
          close.matrix().cwiseProduct(samples.area_mm2.segment(first, count)).transpose() * around;
      if (sum.norm() > 0) smooth.row(i) = sum.cast<double>().normalized();
    }
  });
  return smooth;
}

LocatedSamples located(const Points& places, const Points& normals, const SurfaceSamples& there, double near_mm,
                       double facing) {
  const Eigen::RowVector3d centre = there.points.colwise().mean();
  const Rows6f a = joint_rows(places, normals, centre, near_mm, facing),
               b = joint_rows(there.points, there.normals, centre, near_mm, facing);
  const auto none = static_cast<float>(unlocated * 2 * std::numbers::pi * near_mm * near_mm);
  LocatedSamples found{places, VertexScalars::Zero(places.rows())};
  in_parallel(places.rows(), [&](Index from, Index to) {
    for (Index i = from; i < to; ++i) {
      const auto [first, count] = rows_within(b.col(there.along), a(i, there.along), locating_reach);
      const Eigen::MatrixX3f away = b.block(first, 0, count, 3).rowwise() - a.block<1, 3>(i, 0);
      const Eigen::ArrayXf away2 = away.rowwise().squaredNorm(),
                           apart2 = (b.middleRows(first, count).rowwise() - a.row(i)).rowwise().squaredNorm();
      const Eigen::ArrayXf within = (1 - away2 / (locating_reach * locating_reach)).max(0);
      const Eigen::VectorXf likely =
          within * (apart2 / -2).max(least_exponent).exp() * there.area_mm2.segment(first, count).array();
      // What lies nowhere stays.
      const float all = likely.sum() + none;
      const Eigen::RowVector3f mean = likely.transpose() * away / all;
      const float mean_square = (likely.dot(away2.matrix()) + 2 * none) / all;
      const float variance = (mean_square - mean.squaredNorm()) / 2 + finest_variance, known = 1 / variance - 1;
      if (!(known > least_known)) continue;
      found.known[i] = known;
      // What the normals tell without the first guess, which holds the place where it is.
      const float farther = std::min(1 / (1 - variance), locating_reach / std::max(mean.norm(), 1e-6F));
      found.targets.row(i) += near_mm * farther * mean.cast<double>();
    }
  });
  return found;
}

DrawnSamples drawn(const SurfaceSamples& own, const SurfaceSamples& there, double near_mm, double facing) {
  const Eigen::RowVector3d centre = there.points.colwise().mean();
  const Rows6f a = joint_rows(own.points, own.normals, centre, near_mm, facing),
               b = joint_rows(there.points, there.normals, centre, near_mm, facing);
  const Eigen::VectorXf a2 = a.rowwise().squaredNorm() / 2, b2 = b.rowwise().squaredNorm() / 2;
  std::vector<Rows> near_ones;
  Index pairs = 0, most = 0;
  for (Index i = 0; i < a.rows(); ++i) {
    near_ones.push_back(rows_within(b.col(there.along), a(i, there.along)));
    pairs += near_ones.back().count;
    most = std::max(most, near_ones.back().count);
  }

  const auto none = static_cast<float>(unmatched * 2 * std::numbers::pi * near_mm * near_mm);
  Eigen::VectorXf of_own = Eigen::VectorXf::Constant(a.rows(), none),
                  of_there = Eigen::VectorXf::Constant(b.rows(), none);
  Eigen::VectorXf likely(pairs);  // each sample's near ones, one sample after the other
  for (Index i = 0, at = 0; i < a.rows(); ++i) {
    const auto [first, count] = near_ones[i];
    auto row = likely.segment(at, count);
    row.noalias() = b.middleRows(first, count) * a.row(i).transpose();
    row = (row - b2.segment(first, count)).array() - a2[i];
    row = row.array().max(least_exponent).min(0).exp().matrix();
    of_own[i] += row.dot(there.area_mm2.segment(first, count));
    of_there.segment(first, count) += own.area_mm2[i] * row;
    at += count;
  }

  const Eigen::VectorXf forth = own.area_mm2.cwiseQuotient(of_own), back = there.area_mm2.cwiseQuotient(of_there);
  DrawnSamples drawn{own.points, VertexScalars(a.rows())};
  Eigen::VectorXf pulls(most);
  for (Index i = 0, at = 0; i < a.rows(); ++i) {
    const auto [first, count] = near_ones[i];
    auto pull = pulls.head(count);
    pull = likely.segment(at, count).cwiseProduct(forth[i] * there.area_mm2.segment(first, count) +
                                                  own.area_mm2[i] * back.segment(first, count));
    at += count;
    const float weight = pull.sum();
    drawn.weights[i] = weight;
    if (!(weight > 0)) continue;
    const Eigen::RowVector3f place = pull.transpose() * b.block(first, 0, count, 3) / weight;
    drawn.targets.row(i) = centre + near_mm * place.cast<double>();
  }
  return drawn;
}

}  // namespace homolog
