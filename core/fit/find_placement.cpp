#include "core/fit/find_placement.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/mirror.h"
#include "core/mesh/surface_search.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr double most_tilt = 60 * std::numbers::pi / 180;
constexpr Eigen::Index samples = 300;  ///< of each surface
constexpr int most_placement_rounds = 40;

/// Area-weighted moments of a surface.
struct Moments {
  Vec3 centre = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< columns: a right-handed frame, the longest axis first
  double size_mm = 0;            ///< root mean square distance from the centre
};

Moments moments_of(const Mesh& mesh) {
  const Triangles& triangles = mesh.topology->triangles();
  double area = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Vec3 a = mesh.points.row(triangles(f, 0)), b = mesh.points.row(triangles(f, 1)),
               c = mesh.points.row(triangles(f, 2));
    const double part = area_normal(mesh, f).norm() / 2;
    const Vec3 middle = (a + b + c) / 3;
    area += part;
    first += part * middle;
    second += part * middle * middle.transpose();
  }
  Moments moments;
  moments.centre = first / area;
  const Mat3 spread = second / area - moments.centre * moments.centre.transpose();
  moments.size_mm = std::sqrt(spread.trace());
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(spread);
  moments.axes = solver.eigenvectors().rowwise().reverse();
  if (moments.axes.determinant() < 0) moments.axes.col(2) *= -1;
  return moments;
}

/// The 24 proper rotations that carry the axes of a frame to axes.
std::vector<Mat3> axis_turns() {
  std::vector<Mat3> turns;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 turn = Mat3::Zero();
      for (int k = 0; k < 3; ++k) turn(order[static_cast<std::size_t>(k)], k) = (signs >> k & 1) != 0 ? -1 : 1;
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

/// Closest points between samples of the template and of the boundary; the template stays where it is, so that its
/// search tree is made once.
class ClosestPoints {
 public:
  ClosestPoints(const Template& reference, const Boundary& boundary)
      : boundary_(boundary), on_boundary_(boundary.surface), on_template_({reference.topology, reference.points}) {
    for (Eigen::Index i = 0; i < reference.points.rows(); i += stride(reference.points))
      own_.push_back(reference.points.row(i));
    const Points& there = boundary.surface.points;
    for (Eigen::Index i = 0; i < there.rows(); i += stride(there))
      if (boundary.shows(there.row(i))) there_.push_back(there.row(i));
  }

  FoundPlacement refined(Similarity placement, double most_turn) const {
    const Eigen::Quaterniond start = placement.rotation;
    double distance = 0;
    for (int round = 0; round < most_placement_rounds; ++round) {
      const auto [from, to] = pairs(placement);
      distance = std::sqrt((placement.apply(from) - to).rowwise().squaredNorm().mean());
      const Similarity next = fit_similarity(from, to, placement);
      if (next.rotation.angularDistance(start) > most_turn) break;
      const bool settled =
          next.rotation.angularDistance(placement.rotation) < 2e-3 && std::abs(next.scale / placement.scale - 1) < 2e-3;
      placement = next;
      if (settled) break;
    }
    return {placement, distance};
  }

 private:
  static Eigen::Index stride(const Points& points) { return 1 + points.rows() / samples; }

  /// Points of the template in its own frame, and where the boundary has them.
  std::pair<Points, Points> pairs(const Similarity& placement) const {
    std::vector<Vec3> from, to;
    for (const Vec3& p : own_) {
      const Vec3 placed = placement.apply(p);
      if (!boundary_.shows(placed)) continue;
      const Vec3 nearest = on_boundary_.nearest(placed).position;
      if (!boundary_.shows(nearest)) continue;
      from.push_back(p);
      to.push_back(nearest);
    }
    const Similarity back = placement.inverse();
    for (const Vec3& p : there_) {
      from.push_back(on_template_.nearest(back.apply(p)).position);
      to.push_back(p);
    }
    return {rows_of(from), rows_of(to)};
  }
  static Points rows_of(const std::vector<Vec3>& list) {
    Points points(static_cast<Eigen::Index>(list.size()), 3);
    for (std::size_t k = 0; k < list.size(); ++k) points.row(static_cast<Eigen::Index>(k)) = list[k].transpose();
    return points;
  }

  const Boundary& boundary_;
  SurfaceSearch on_boundary_, on_template_;
  std::vector<Vec3> own_, there_;
};

}  // namespace

FoundPlacement refine_placement(const Template& reference, const Boundary& boundary, const Similarity& start) {
  return ClosestPoints(reference, boundary).refined(start, most_tilt);
}

FoundPlacement find_placement(const Template& reference, const Boundary& boundary,
                              const std::map<std::string, Vec3>& landmarks, Orientation orientation) {
  const ClosestPoints closest(reference, boundary);
  const Moments from = moments_of({reference.topology, reference.points}), to = moments_of(boundary.surface);
  const auto at = [&](const Eigen::Quaterniond& rotation) {
    const double scale = to.size_mm / from.size_mm;
    return Similarity{rotation, scale, to.centre - scale * (rotation * from.centre)};
  };
  if (const auto [own, there] = matched_landmarks(reference, landmarks); own.rows() >= 3) {
    const Similarity placed = fit_similarity(own, there, at(Eigen::Quaterniond::Identity()));
    return closest.refined(placed, 0);
  }
  FoundPlacement best;
  best.distance_mm = std::numeric_limits<double>::infinity();
  for (const Eigen::Quaterniond& start : starts_of(from, to, orientation)) {
    const FoundPlacement found = closest.refined(at(start), most_tilt);
    const bool upright = orientation == Orientation::any || angle_of(found.placement.rotation) < most_tilt;
    if (upright && found.distance_mm < best.distance_mm) best = found;
  }
  // Nothing near the patient's axes settled: upright, by moments alone.
  if (!std::isfinite(best.distance_mm)) best = closest.refined(at(Eigen::Quaterniond::Identity()), 0);
  return best;
}

bool looks_mirrored(const Template& reference, const Boundary& boundary) {
  constexpr double clearly = 0.85;
  const auto other = make_template(mirrored(to_mesh_file(reference)), reference.source);
  if (!other) return false;
  const double own_mm = find_placement(reference, boundary, {}, Orientation::patient).distance_mm;
  return find_placement(**other, boundary, {}, Orientation::patient).distance_mm < clearly * own_mm;
}

}  // namespace homolog
