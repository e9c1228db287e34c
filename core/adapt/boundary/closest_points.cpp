#include "core/adapt/boundary/closest_points.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr Eigen::Index surface_samples = 300;  ///< samples of each surface
/// How far an organ's surface lies from its template's under the right similarity, as a share of the diagonal, and of
/// how many places on it one may say so independently.
constexpr double surface_deviation_share = 0.02, independent_places = 100;
constexpr double blunders = 0.05;  ///< share of named places that are no places of that name
/// Share of the diagonal: surfaces farther apart have no counterpart, where parts may be missing. And how much a place
/// of the template counts there against one of the boundary, which is mostly the organ's.
constexpr double missing_share = 0.05, missing_counts = 0.4;

constexpr double near_the_end = 2e-3;  ///< share of the organ's size: such steps and shorter ones are near the end
using Matrix7 = Eigen::Matrix<double, 7, 7>;

Eigen::Matrix<double, 7, 1> moved_along(const Vec3& normal, const Vec3& from_centre) {
  Eigen::Matrix<double, 7, 1> step;
  step << from_centre.cross(normal), normal, normal.dot(from_centre);
  return step;
}

/// Some of many points, at equal steps.
std::vector<Vec3> sampled(const Points& points) {
  std::vector<Vec3> samples;
  const Eigen::Index stride = 1 + points.rows() / surface_samples;
  for (Eigen::Index i = 0; i < points.rows(); i += stride) samples.push_back(points.row(i));
  return samples;
}

}  // namespace

/// A placement with what is seen there.
struct ClosestPoints::State {
  struct Gap {
    Vec3 at, normal;  ///< the placed template's; away from the boundary along `normal`
    double mm = 0;
    double weight = 1;  ///< less where one of the surfaces seems to lack the place
  };
  Similarity placement;
  std::vector<Gap> gaps;
  std::vector<std::int32_t> faces;  ///< nearest to each sample, the template's before the boundary's
  VertexScalars trust;
  double squares_mm2 = 0, cost = 0;
};

struct ClosestPoints::System {
  Matrix7 matrix = Matrix7::Zero();
  Step gradient = Step::Zero();
  void add(const Step& way, double residual, double weight) {
    matrix += weight * way * way.transpose();
    gradient += weight * residual * way;
  }
};

ClosestPoints::ClosestPoints(const Template& the_template, const Boundary& boundary, bool partial)
    : boundary_(&boundary),
      on_boundary_(boundary.surface),
      on_template_({the_template.topology, the_template.points}),
      partial_(partial) {
  own_ = sampled(the_template.points);
  there_ = sampled(boundary.surface.points);
  std::erase_if(there_, [&](const Vec3& p) { return !boundary.shows(p); });
  if (!boundary.cut.empty())
    std::erase_if(there_, [&](const Vec3& p) { return !boundary.is_own(on_boundary_->nearest(p).at.face); });
  weigh(boundary.surface.points);
}

ClosestPoints::ClosestPoints(const Template& the_template, const Points& places)
    : on_template_({the_template.topology, the_template.points}), there_(sampled(places)) {
  weigh(places);
}

void ClosestPoints::weigh(const Points& there) {
  diagonal_mm_ = bounds_of(there).diagonal().norm();
  const double deviation_mm = surface_deviation_share * diagonal_mm_;
  sample_weight_ =
      independent_places / (static_cast<double>(own_.size() + there_.size()) * deviation_mm * deviation_mm);
}

ClosestPoints::State ClosestPoints::look(const Similarity& placement, const PlacementPrior& prior,
                                         const KnownPlaces& places,
                                         const std::vector<std::int32_t>& likely_faces) const {
  State state{placement, {}, likely_faces, VertexScalars::Ones(places.own.rows()), 0, 0};
  state.faces.resize(own_.size() + there_.size(), 0);
  auto face = state.faces.begin();
  const double missing_mm = missing_share * diagonal_mm_;
  const auto add = [&](const Vec3& at, const Vec3& apart, const auto& facing, double counts) {
    const double mm = apart.norm();
    constexpr double touching = 1e-9;
    // Geman and McClure's: the square of a short distance, and missing_mm's of any long one.
    const double kept = partial_ ? 1 / (1 + mm * mm / (missing_mm * missing_mm)) : 1;
    state.gaps.push_back({at, mm > touching * diagonal_mm_ ? Vec3(apart / mm) : facing(), mm, counts * kept * kept});
    state.squares_mm2 += counts * kept * mm * mm;
  };
  for (const Vec3& p : own_) {
    const Vec3 placed = placement.apply(p);
    std::int32_t& likely = *face++;
    if (!boundary_->shows(placed)) continue;
    const auto nearest = on_boundary_->nearest(placed, likely);
    likely = nearest.at.face;
    if (!boundary_->shows(nearest.position)) continue;
    if (partial_ && (!boundary_->is_own(nearest.at.face) || on_rim(*boundary_->surface.topology, nearest.at))) {
      state.squares_mm2 += missing_counts * missing_mm * missing_mm;
      continue;
    }
    add(
        placed, placed - nearest.position,
        [&] { return area_normal(on_boundary_->mesh(), nearest.at.face).stableNormalized(); },
        partial_ ? missing_counts : 1);
  }
  const Similarity back = placement.inverse();
  for (const Vec3& p : there_) {
    std::int32_t& likely = *face++;
    const auto nearest = on_template_.nearest(back.apply(p), likely);
    likely = nearest.at.face;
    const Vec3 placed = placement.apply(nearest.position);
    add(
        placed, placed - p,
        [&] { return Vec3(placement.rotation * area_normal(on_template_.mesh(), nearest.at.face).stableNormalized()); },
        1);
  }
  const double noise_mm = landmark_deviation_share * diagonal_mm_;
  const double noise_volume = std::pow(2 * std::numbers::pi, 1.5) * std::pow(landmark_deviation_share, 3);
  const double elsewhere = blunders / (1 - blunders) * noise_volume;  // anywhere about the organ
  for (Eigen::Index k = 0; k < places.own.rows(); ++k) {
    const Vec3 off = placement.apply(Vec3(places.own.row(k))) - Vec3(places.there.row(k));
    const double meant = std::exp(-off.squaredNorm() / (2 * noise_mm * noise_mm));
    state.trust[k] = meant / (meant + elsewhere);
    state.cost -= std::log(meant + elsewhere);
  }
  const Mat3 turn = (placement.rotation * prior.around.rotation.conjugate()).toRotationMatrix();
  const double growth = std::log(placement.scale / prior.around.scale) / prior.size_deviation;
  state.cost +=
      sample_weight_ / 2 * state.squares_mm2 + prior.concentration() * (3 - turn.trace()) + growth * growth / 2;
  return state;
}

ClosestPoints::System ClosestPoints::system_at(const State& state, const PlacementPrior& prior,
                                               const KnownPlaces& places) const {
  System system;
  const Vec3 centre = state.placement.apply(Vec3(on_template_.mesh().points.colwise().mean()));
  for (const State::Gap& gap : state.gaps)
    system.add(moved_along(gap.normal, gap.at - centre), gap.mm, gap.weight * sample_weight_);
  const double noise_mm = landmark_deviation_share * diagonal_mm_;
  for (Eigen::Index k = 0; k < places.own.rows(); ++k) {
    const Vec3 at = state.placement.apply(Vec3(places.own.row(k)));
    const Vec3 off = at - Vec3(places.there.row(k));
    for (int axis = 0; axis < 3; ++axis)
      system.add(moved_along(Vec3::Unit(axis), at - centre), off[axis], state.trust[k] / (noise_mm * noise_mm));
  }
  const Mat3 turn = (state.placement.rotation * prior.around.rotation.conjugate()).toRotationMatrix();
  const double concentration = prior.concentration(), firmness = std::pow(prior.size_deviation, -2);
  system.gradient.head<3>() +=
      concentration * Vec3(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  system.matrix.topLeftCorner<3, 3>() += 2 * concentration * Mat3::Identity();
  system.gradient[6] += firmness * std::log(state.placement.scale / prior.around.scale);
  system.matrix(6, 6) += firmness;
  return system;
}

Similarity ClosestPoints::moved(const Similarity& placement, const Step& way) const {
  const Vec3 middle = on_template_.mesh().points.colwise().mean(), turn = way.head<3>();
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
  Similarity next;
  next.rotation = (turned * placement.rotation).normalized();
  next.scale = placement.scale * std::exp(way[6]);
  next.translation = placement.apply(middle) + way.segment<3>(3) - next.scale * (next.rotation * middle);
  return next;
}

Placed ClosestPoints::refined(const Similarity& start, double most_turn, const PlacementPrior& prior,
                              const KnownPlaces& places, double rest, int most_steps) const {
  State state = look(start, prior, places, {});
  System system = system_at(state, prior, places);
  double damping = 1e-3;
  constexpr double rounding = 1e-11;  // share of a cost that is some tens
  for (int step = 0; step < most_steps && damping < 1e9; ++step) {
    Matrix7 matrix = system.matrix;
    matrix.diagonal() *= 1 + damping;
    const Step way = -matrix.ldlt().solve(system.gradient);
    const double length_mm = (way.head<3>().norm() + std::abs(way[6])) * diagonal_mm_ + way.segment<3>(3).norm();
    if (length_mm < rest * diagonal_mm_) break;
    State tried = look(moved(state.placement, way), prior, places, state.faces);
    if (tried.cost > state.cost + rounding) {
      damping *= 8;
      continue;
    }
    damping = damping / 8;
    if (tried.placement.rotation.angularDistance(prior.around.rotation) > most_turn) break;
    System next = system_at(tried, prior, places);
    // Gauss-Newton leaves out how the surfaces bend. Near the end their bend is learnt from the gradient, as in BFGS.
    const Step change = next.gradient - system.gradient;
    if (length_mm < near_the_end * diagonal_mm_ && change.dot(way) > 0) {
      const Step along = system.matrix * way;
      next.matrix =
          system.matrix + change * change.transpose() / change.dot(way) - along * along.transpose() / along.dot(way);
    }
    state = std::move(tried);
    system = std::move(next);
  }
  const auto pairs = static_cast<double>(std::max<std::size_t>(1, state.gaps.size()));
  return {state.placement, std::sqrt(state.squares_mm2 / pairs), state.cost, state.trust};
}

}  // namespace homolog
