#include "core/adapt/boundary/find_placement.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/numbers/statistics.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr double most_tilt = 60 * std::numbers::pi / 180;
constexpr double nearly = 1e-3, at_rest = 1e-9;  // steps, as shares of the organ's size
constexpr double everywhere = 2 * std::numbers::pi;
constexpr double any_turn = std::numbers::pi;  ///< standard deviation: next to nothing is known

/// Area-weighted moments of a surface.
struct Moments {
  Vec3 centre = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< columns: a right-handed frame, the longest axis first
  double size_mm = 0;            ///< root mean square distance from the centre
};

/// `spread`: the mean of (p − centre)·(p − centre)ᵀ, mm².
Moments moments_about(const Vec3& centre, const Mat3& spread) {
  Moments moments;
  moments.centre = centre;
  moments.size_mm = std::sqrt(spread.trace());
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
  moments.axes = solver.eigenvectors().rowwise().reverse();
  if (moments.axes.determinant() < 0) moments.axes.col(2) *= -1;
  return moments;
}

/// `keeps`: whether a face with this middle counts.
template <class Keeps>
Moments moments_of(const Mesh& mesh, const Keeps& keeps) {
  const Triangles& triangles = mesh.topology->triangles();
  double area = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Vec3 a = mesh.points.row(triangles(f, 0)), b = mesh.points.row(triangles(f, 1)),
               c = mesh.points.row(triangles(f, 2));
    const double part = area_normal(mesh, f).norm() / 2;
    const Vec3 middle = (a + b + c) / 3;
    if (!keeps(middle)) continue;
    area += part;
    first += part * middle;
    second += part * middle * middle.transpose();
  }
  const Vec3 centre = first / area;
  return moments_about(centre, second / area - centre * centre.transpose());
}

Moments moments_of(const Mesh& mesh) {
  return moments_of(mesh, [](const Vec3&) { return true; });
}

/// Moments of points that count alike.
Moments moments_of(const Points& points) {
  const Vec3 centre = points.colwise().mean().transpose();
  const Points from = points.rowwise() - centre.transpose();
  return moments_about(centre, from.transpose() * from / static_cast<double>(points.rows()));
}

/// The moments of what may be left of a template: the whole, and without its ends along axes and diagonals.
std::vector<Moments> moments_of_parts(const Mesh& mesh, const Moments& whole) {
  std::vector<Moments> parts{whole};
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Vec3 along = (whole.axes * Vec3(x, y, z)).normalized();
        const Eigen::VectorXd height = mesh.points * along;
        std::vector<double> heights(height.begin(), height.end());
        for (const double left : {0.85, 0.65}) {
          const double limit = quantile(heights, left);
          parts.push_back(moments_of(mesh, [&](const Vec3& middle) { return middle.dot(along) <= limit; }));
        }
      }
  return parts;
}

/// The 24 proper rotations that carry the axes of a frame to axes.
std::vector<Mat3> axis_turns() {
  std::vector<Mat3> turns;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 turn = Mat3::Zero();
      for (int k = 0; k < 3; ++k) turn(order[k], k) = (signs >> k & 1) != 0 ? -1 : 1;
      if (turn.determinant() > 0) turns.push_back(turn);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return turns;
}

double angle_of(const Eigen::Quaterniond& rotation) {
  return Eigen::AngleAxisd(rotation).angle();
}

/// Rotations to start from, by what moments and patient axes know.
std::vector<Eigen::Quaterniond> starts_of(const Moments& from, const Moments& to, Orientation orientation) {
  std::vector<Eigen::Quaterniond> starts{Eigen::Quaterniond::Identity()}, turned;
  for (const Mat3& turn : axis_turns()) turned.emplace_back(Mat3(to.axes * turn * from.axes.transpose()));
  if (orientation == Orientation::any) {
    starts.insert(starts.end(), turned.begin(), turned.end());
    return starts;
  }
  const auto upright = *std::min_element(
      turned.begin(), turned.end(), [](const auto& a, const auto& b) { return std::abs(a.w()) > std::abs(b.w()); });
  if (angle_of(upright) < most_tilt) starts.push_back(upright);
  return starts;
}

struct Start {
  Similarity placement;
  double farthest;  ///< the farthest that it may turn away from what is likely beforehand, radians
};

/// Keeps of many starts those that a few steps bring nearest.
void keep_promising(const ClosestPoints& closest, const PlacementPrior& prior, const KnownPlaces& places,
                    std::vector<Start>& starts) {
  constexpr int few_steps = 8;
  constexpr std::size_t most = 4;
  std::vector<std::pair<double, std::size_t>> costs;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const Placed found = closest.refined(starts[k].placement, starts[k].farthest, prior, places, nearly, few_steps);
    starts[k].placement = found.placement;
    costs.emplace_back(found.cost, k);
  }
  std::sort(costs.begin(), costs.end());
  std::vector<Start> promising;
  for (std::size_t k = 0; k < std::min(most, costs.size()); ++k) promising.push_back(starts[costs[k].second]);
  starts = std::move(promising);
}

/// The similarity that carries moments to others, with this rotation.
Similarity onto(const Moments& part, const Moments& there, const Eigen::Quaterniond& rotation) {
  const double scale = there.size_mm / part.size_mm;
  return Similarity{rotation, scale, there.centre - scale * (rotation * part.centre)};
}

/// The likeliest placement that is found from one of some moments of the template (`from`, the whole first) and of the
/// organ (`to`). `rest`: the last step, as a share of the organ's size.
Placed likeliest(const Template& the_template, const ClosestPoints& closest, const std::vector<Moments>& from,
                 const std::vector<Moments>& to, const PlacementHints& hints, double rest) {
  const bool any = hints.orientation == Orientation::any && !hints.start;
  const PlacementPrior prior{hints.start.value_or(onto(from.front(), to.front(), Eigen::Quaterniond::Identity())),
                             any ? any_turn : PlacementPrior{}.turn_rad,
                             hints.size_deviation.value_or(PlacementPrior{}.size_deviation)};
  // Without landmarks the best overlap alone is anatomically wrong too often.
  const double farthest = any ? everywhere : most_tilt;
  std::vector<Start> starts;
  if (hints.start) {
    starts.push_back({*hints.start, farthest});
  } else {
    for (const Moments& part : from)
      for (const Moments& there : to)
        for (const Eigen::Quaterniond& start : starts_of(part, there, hints.orientation))
          starts.push_back({onto(part, there, start), farthest});
  }
  KnownPlaces places;
  if (auto [own, there] = matched_landmarks(the_template, hints.landmarks); own.rows() >= fewest_placing_landmarks) {
    places = {std::move(own), std::move(there)};
    const Similarity likely =
        likely_similarity(places.own, places.there, prior, bounds_of(the_template.points).diagonal().norm());
    if (likely.scale > 0) starts.push_back({likely, everywhere});
  }
  if (hints.partial || hints.cut_template) keep_promising(closest, prior, places, starts);
  Placed best;
  best.cost = std::numeric_limits<double>::infinity();
  double farthest_of_best = 0;
  for (const Start& start : starts) {
    Placed found = closest.refined(start.placement, start.farthest, prior, places, nearly);
    if (found.cost < best.cost) {
      best = std::move(found);
      farthest_of_best = start.farthest;
    }
  }
  return closest.refined(best.placement, farthest_of_best, prior, places, rest);
}

/// find_placement; `rest`: the last step, as a share of the organ's size.
Placed placed(const Template& the_template, const Boundary& boundary, const PlacementHints& hints, double rest) {
  const ClosestPoints closest(the_template, boundary, hints.partial || hints.cut_template);
  const Mesh own{the_template.topology, the_template.points};
  const Moments from = moments_of(own), to = moments_of(boundary.surface);
  return likeliest(the_template, closest, hints.partial ? moments_of_parts(own, from) : std::vector{from},
                   hints.cut_template ? moments_of_parts(boundary.surface, to) : std::vector{to}, hints, rest);
}

/// Root mean square distance of about 1,500 points from a surface.
double one_way_distance_mm(const Points& points, const Mesh& surface) {
  constexpr Eigen::Index enough = 1500;
  const SurfaceSearch search(surface);
  const Eigen::Index step = std::max<Eigen::Index>(1, points.rows() / enough);
  double sum_mm2 = 0;
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.rows(); i += step, ++count)
    sum_mm2 += (search.nearest(points.row(i)).position - Vec3(points.row(i))).squaredNorm();
  return std::sqrt(sum_mm2 / static_cast<double>(count));
}

}  // namespace

Placed find_placement(const Template& the_template, const Boundary& boundary, const PlacementHints& hints) {
  return placed(the_template, boundary, hints, at_rest);
}

Placed find_placement(const Template& the_template, const Points& places, const PlacementHints& hints) {
  PlacementHints whole = hints;
  whole.partial = whole.cut_template = false;
  return likeliest(the_template, ClosestPoints(the_template, places),
                   {moments_of(Mesh{the_template.topology, the_template.points})}, {moments_of(places)}, whole,
                   at_rest);
}

std::optional<OtherLie> other_lie(const Template& the_template, const Boundary& boundary, Orientation orientation,
                                  bool turns, bool partial) {
  // Costs are minus the logarithm of a likelihood. The other side lowers the cost of kidneys, femora, hips and patellae
  // by 17 or more, and to 0.67 of it or less, but for one kidney in 25. On the same side it raises the cost by 18 or
  // more; vertebrae differ by 3. Another organ costs hundreds either way, so a small part of that tells nothing.
  constexpr double clearly = 10, clearly_less = 0.75;
  constexpr double clearly_share = 0.65;  // cut femora and hips, one way: 0.1 to 1.25, and 0.8 to 8
  constexpr double turn_share = 0.8;      // for partial fits: an organ may be like its mirror image but for a half turn
  constexpr double visible_share = 0.005;  // share of the diagonal: below, a ball would look mirrored by its noise
  struct There {
    Points points;
    double distance_mm, cost;
  };
  const auto there = [&](const Template& lying) -> There {
    const Placed found = placed(lying, boundary, {.orientation = orientation, .partial = partial}, nearly);
    Points points = found.placement.apply(lying.points);
    const double distance_mm =
        partial ? one_way_distance_mm(boundary.surface.points, {lying.topology, points}) : found.distance_mm;
    return {std::move(points), distance_mm, found.cost};
  };
  const There own = there(the_template);
  if (!(own.distance_mm > visible_share * bounds_of(boundary.surface.points).diagonal().norm())) return std::nullopt;
  const MeshFile file = to_mesh_file(the_template);
  const auto other_side = make_template(mirrored(file), the_template.source);
  if (!other_side) return std::nullopt;
  There best = there(**other_side);
  bool half_turned = false;
  if (turns) {
    MeshFile turned = file;
    turned.points.leftCols<2>() *= -1;
    turned.landmarks.clear();
    if (const auto from_ras = make_template(turned, the_template.source)) {
      There found = there(**from_ras);
      // Costs of kidneys differ by 16 or more where they are mirrored, and by 6 or more where they are turned.
      half_turned = partial ? found.distance_mm < turn_share * best.distance_mm : found.cost < best.cost;
      if (half_turned) best = std::move(found);
    }
  }
  const bool likelier = partial ? best.distance_mm < clearly_share * own.distance_mm
                                : best.cost < std::min(own.cost - clearly, clearly_less * own.cost);
  if (!likelier) return std::nullopt;
  return OtherLie{half_turned, std::move(best.points)};
}

}  // namespace homolog
