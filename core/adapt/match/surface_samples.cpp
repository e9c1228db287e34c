#include "core/adapt/match/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

using Eigen::Index;
using Rows6f = Eigen::Matrix<float, Eigen::Dynamic, 6>;

constexpr Index most_candidates = 40000;  ///< of the vertices that are spread
constexpr double unmatched = 0.01;        ///< of what a full match weighs: belonging to none
constexpr float least_exponent = -16;     ///< smaller probabilities are lost in the sums

/// Half the width within which a probability is not lost, in units of the distance that counts as near.
const float reach = std::sqrt(-2 * least_exponent);

struct Rows {
  Index first, count;
};

/// The rows whose value lies within `reach` of `middle`. `values` ascend.
Rows rows_within(const Eigen::Ref<const Eigen::VectorXf>& values, float middle) {
  const auto from = std::lower_bound(values.begin(), values.end(), middle - reach);
  const auto to = std::upper_bound(from, values.end(), middle + reach);
  return {from - values.begin(), to - from};
}

/// Of each place its share of the area. The denser they lie, the less each stands for. A count of what lies nearest to
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
  Eigen::VectorXd away = Eigen::VectorXd::Constant(places.rows(), std::numeric_limits<double>::infinity());
  for (Index next = 0; std::ssize(picked) < std::min(count, places.rows()) && away[next] > 0; away.maxCoeff(&next)) {
    picked.push_back(candidates[static_cast<std::size_t>(next)]);
    const VertexScalars from_next2 = (places.rowwise() - places.row(next)).rowwise().squaredNorm();
    away = away.cwiseMin((from_next2 * (steps / radius2)).array().floor().matrix());
  }
  return picked;
}

SurfaceSamples samples_of(const Mesh& mesh, const Points& normals, std::vector<Index> vertices) {
  Index along = 0;
  bounds_of(mesh.points).sizes().maxCoeff(&along);
  std::ranges::stable_sort(vertices, {}, [&](Index v) { return mesh.points(v, along); });
  SurfaceSamples samples{mesh.points(vertices, Eigen::all), normals(vertices, Eigen::all), {}, along};
  const double area_mm2 = surface_area_mm2(mesh);
  const double spacing_mm = std::sqrt(area_mm2 / static_cast<double>(vertices.size()));
  const Eigen::RowVector3d centre = samples.points.colwise().mean();
  const Eigen::MatrixX3f places = ((samples.points.rowwise() - centre) / spacing_mm).cast<float>();
  samples.area_mm2 = static_cast<float>(area_mm2) * area_shares(places, along);
  return samples;
}

DrawnSamples drawn(const SurfaceSamples& own, const SurfaceSamples& there, double near_mm, double facing) {
  const Eigen::RowVector3d centre = there.points.colwise().mean();
  // The exponent of each pair is minus half the squared distance between rows of place and normal.
  const auto joint = [&](const SurfaceSamples& samples) {
    Rows6f rows(samples.points.rows(), 6);
    rows.leftCols<3>() = ((samples.points.rowwise() - centre) / near_mm).cast<float>();
    rows.rightCols<3>() = (facing * samples.normals).cast<float>();
    return rows;
  };
  const Rows6f a = joint(own), b = joint(there);
  const Eigen::VectorXf a2 = a.rowwise().squaredNorm() / 2, b2 = b.rowwise().squaredNorm() / 2;
  const auto near_ones = [&](Index i) { return rows_within(b.col(there.along), a(i, there.along)); };

  const auto none = static_cast<float>(unmatched * 2 * std::numbers::pi * near_mm * near_mm);
  Eigen::VectorXf of_own = Eigen::VectorXf::Constant(a.rows(), none),
                  of_there = Eigen::VectorXf::Constant(b.rows(), none);
  std::vector<Eigen::VectorXf> likely(static_cast<std::size_t>(a.rows()));
  for (Index i = 0; i < a.rows(); ++i) {
    const auto [first, count] = near_ones(i);
    const Eigen::VectorXf exponents =
        (b.middleRows(first, count) * a.row(i).transpose() - b2.segment(first, count)).array() - a2[i];
    Eigen::VectorXf& row = likely[static_cast<std::size_t>(i)];
    row = exponents.array().max(least_exponent).min(0).exp().matrix();
    of_own[i] += row.dot(there.area_mm2.segment(first, count));
    of_there.segment(first, count) += own.area_mm2[i] * row;
  }

  const Eigen::VectorXf forth = own.area_mm2.cwiseQuotient(of_own), back = there.area_mm2.cwiseQuotient(of_there);
  DrawnSamples drawn{own.points, VertexScalars(a.rows())};
  for (Index i = 0; i < a.rows(); ++i) {
    const auto [first, count] = near_ones(i);
    const Eigen::VectorXf pull = likely[static_cast<std::size_t>(i)].cwiseProduct(
        forth[i] * there.area_mm2.segment(first, count) + own.area_mm2[i] * back.segment(first, count));
    const float weight = pull.sum();
    drawn.weights[i] = weight;
    if (!(weight > 0)) continue;
    const Eigen::RowVector3f place = pull.transpose() * b.block(first, 0, count, 3) / weight;
    drawn.targets.row(i) = centre + near_mm * place.cast<double>();
  }
  return drawn;
}

}  // namespace homolog
