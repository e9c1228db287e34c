#include "core/groupwise/sliding_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/deform/fold_guard.h"
#include "core/deform/local_rotations.h"
#include "core/deform/surface_walk.h"
#include "core/deform/tangential.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double reach_edges = 0.1;     ///< mean edges: how far a vertex is drawn at most where no feature decides
constexpr double surface_share = 0.07;  ///< share of the mean edge: how far the surface may move where it is looked at
constexpr double quality_floor = 0.1, kept_share = 0.5;  ///< a triangle's, and a share of its quality at first
constexpr int most_tries = 10, halvings = 2;

double quality_of(const Points& p, const auto& t) {
  return triangle_quality(p.row(t[0]), p.row(t[1]), p.row(t[2]));
}

/// Whether the surface comes within `reach_mm` of `x`, told by the faces around `near` and by a walk from there; `near`
/// becomes the place that was found. Mostly the face itself is near enough, and then it costs little.
bool comes_near(const Topology& topology, const Points& points, const Vec3& x, double reach_mm, SurfacePoint& near) {
  const auto t = topology.triangles().row(near.face);
  const Vec3 weights = nearest_in_triangle(x, points.row(t[0]), points.row(t[1]), points.row(t[2]));
  if ((SurfacePoint{near.face, weights}.interpolate(topology, points).transpose() - x).norm() <= reach_mm) return true;
  const auto nearest = walk_to_nearest(topology, points, near, x);
  near = nearest.at;
  return nearest.distance_mm <= reach_mm;
}

/// The gradients of what is given per vertex, area-weighted over the faces around each vertex.
std::vector<Eigen::Matrix<double, 3, 6>> gradients_of(const Topology& topology, const Points& points,
                                                      const SurfaceFeatures& features) {
  std::vector<Eigen::Matrix<double, 3, 6>> gradients(static_cast<std::size_t>(points.rows()),
                                                     Eigen::Matrix<double, 3, 6>::Zero());
  VertexScalars areas = VertexScalars::Zero(points.rows());
  for (Eigen::Index f = 0; f < topology.triangles().rows(); ++f) {
    const auto t = topology.triangles().row(f);
    const Vec3 a = points.row(t[0]), b = points.row(t[1]), c = points.row(t[2]);
    const Vec3 normal = (b - a).cross(c - a);
    const double area = normal.norm();
    if (!(area > 0)) continue;
    const Vec3 up = normal / area;
    const Eigen::Matrix<double, 3, 6> steep = up.cross(c - b) * features.row(t[0]) +
                                              up.cross(a - c) * features.row(t[1]) +
                                              up.cross(b - a) * features.row(t[2]);
    for (const std::int32_t v : t) {
      gradients[v] += steep;
      areas[v] += area;
    }
  }
  for (std::size_t v = 0; v < gradients.size(); ++v)
    if (const double area = areas[static_cast<Eigen::Index>(v)]; area > 0) gradients[v] /= area;
  return gradients;
}

}  // namespace

SlidingSurface::SlidingSurface(std::shared_ptr<const Topology> topology, Points start, SurfaceFeatures features,
                               VertexScalars held, std::shared_ptr<const ShapeSolver> solver)
    : topology_(std::move(topology)),
      start_(std::move(start)),
      points_(start_),
      features_(std::move(features)),
      gradients_(gradients_of(*topology_, start_, features_)),
      held_(std::move(held)),
      solver_(std::move(solver)),
      edge_mm_(mean_edge_mm(*topology_, start_)) {
  const Triangles& triangles = topology_->triangles();
  for (Eigen::Index i = 0; i < start_.rows(); ++i) {
    SurfacePoint at;
    at.face = topology_->faces_of(i).front();
    for (int k = 0; k < 3; ++k) at.weights[k] = triangles(at.face, k) == i ? 1 : 0;
    at_.push_back(at);
  }
  covered_ = at_;
  least_quality_.resize(triangles.rows());
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    least_quality_[f] = std::min(quality_floor, kept_share * quality_of(start_, triangles.row(f)));
}

SurfaceFeatures SlidingSurface::features() const {
  SurfaceFeatures there(points_.rows(), 6);
  for (Eigen::Index i = 0; i < there.rows(); ++i) there.row(i) = at_[i].interpolate(*topology_, features_);
  return there;
}

Points SlidingSurface::drawn(const ExpectedShape& expected) const {
  const Points off = tangential({topology_, points_}, expected.points - points_);
  const double near = 1 / (reach_edges * edge_mm_ * reach_edges * edge_mm_) + expected.per_mm * expected.per_mm;
  Points target = points_;
  for (Eigen::Index i = 0; i < points_.rows(); ++i) {
    const SurfacePoint& at = at_[i];
    const auto corners = topology_->triangles().row(at.face);
    Eigen::Matrix<double, 3, 6> gradient = Eigen::Matrix<double, 3, 6>::Zero();
    for (int k = 0; k < 3; ++k) gradient += at.weights[k] * gradients_[corners[k]];
    const Eigen::Matrix<double, 6, 1> lacking =
        (expected.features.row(i) - at.interpolate(*topology_, features_)).transpose();
    const Mat3 bend = gradient * gradient.transpose() + near * Mat3::Identity();
    const Vec3 slope = gradient * lacking + expected.per_mm * expected.per_mm * off.row(i).transpose();
    target.row(i) += bend.llt().solve(slope).transpose();
  }
  return target;
}

void SlidingSurface::move(const Points& offset, const std::set<std::int32_t>& vertices, Place& place) const {
  for (const std::int32_t i : vertices) {
    const auto at = static_cast<std::size_t>(i);
    place.at[at] = at_[at];
    place.points.row(i) = points_.row(i);
    if (offset.row(i).isZero(0)) continue;
    const auto nearest = walk_to_nearest(*topology_, start_, at_[at], (points_.row(i) + offset.row(i)).transpose());
    place.points.row(i) = nearest.position.transpose();
    place.at[at] = nearest.at;
  }
}

std::set<std::int32_t> SlidingSurface::faulty_vertices(const std::set<std::int32_t>& moved, Place& place) const {
  std::set<std::int32_t> vertices;
  const auto add_face = [&](std::int32_t face) {
    for (const std::int32_t v : topology_->triangles().row(face)) vertices.insert(v);
  };
  for (const std::int32_t face : turned_triangles(*topology_, start_, place.points)) add_face(face);
  std::set<std::int32_t> faces;
  for (const std::int32_t i : moved) faces.insert(topology_->faces_of(i).begin(), topology_->faces_of(i).end());
  for (const std::int32_t f : faces)
    if (quality_of(place.points, topology_->triangles().row(f)) < least_quality_[f]) add_face(f);
  const double most_mm = surface_share * edge_mm_;
  for (const std::int32_t i : moved) {
    for (const std::int32_t j : topology_->one_ring(i)) {
      if (j < i && moved.contains(j)) continue;
      const Vec3 middle = (place.points.row(i) + place.points.row(j)).transpose() / 2;
      SurfacePoint near = place.at[i];
      if (!comes_near(*topology_, start_, middle, most_mm, near)) vertices.insert({i, j});
    }
  }
  for (std::size_t i = 0; i < place.covered.size(); ++i) {
    if (!faces.contains(place.covered[i].face)) continue;
    if (!comes_near(*topology_, place.points, start_.row(static_cast<Eigen::Index>(i)).transpose(), most_mm,
                    place.covered[i]))
      add_face(place.covered[i].face);
  }
  return vertices;
}

double SlidingSurface::slide(const ExpectedShape& expected, double share) {
  const Mesh mesh{topology_, points_};
  Points right = drawn(expected) + rotated_reference_force(*topology_, solver_->weights(), start_,
                                                           local_rotations(*topology_, start_, points_));
  if (solver_->hold().size() > 0) right += solver_->hold().asDiagonal() * points_;
  Points offset = share * tangential(mesh, solver_->solve(right) - points_);
  std::set<std::int32_t> moving;
  for (Eigen::Index i = 0; i < offset.rows(); ++i) {
    if (topology_->on_rim(i) || (held_.size() > 0 && held_[i] > 0)) offset.row(i).setZero();
    moving.insert(moving.end(), static_cast<std::int32_t>(i));
  }
  // Around what is faulty the step is made shorter, at last none: without a step there is no fault.
  Place place{points_, at_, covered_};
  for (int k = 0; k < most_tries; ++k) {
    move(offset, moving, place);
    const auto faulty = faulty_vertices(moving, place);
    if (faulty.empty()) {
      const double way_mm = std::sqrt((place.points - points_).squaredNorm() / static_cast<double>(points_.rows()));
      points_ = std::move(place.points);
      at_ = std::move(place.at);
      covered_ = std::move(place.covered);
      return way_mm;
    }
    moving = faulty;
    for (const std::int32_t v : faulty) moving.insert(topology_->one_ring(v).begin(), topology_->one_ring(v).end());
    for (const std::int32_t v : moving) offset.row(v) *= k < halvings ? 0.5 : 0;
  }
  return 0;
}

}  // namespace homolog
