#include "core/deform/fold_guard.h"

#include <algorithm>
#include <cmath>

#include "core/deform/local_rotations.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double usual_reach_mm = 15;  // most drags are shorter; a longer one looks at more faces
constexpr double quality_floor = 0.1;
constexpr double kept_share =
    0.5;  // share of a sliver's own quality: equal to it, the next touch of the sliver would freeze the tool
const double shape_factor = 2 * std::sqrt(3.0);  // quality = shape_factor · |e1 × e2| / Σ edge²

Vec3 face_normal(const Points& p, const auto& t) {
  const Vec3 a = p.row(t[0]), b = p.row(t[1]), c = p.row(t[2]);
  return (b - a).cross(c - a);
}

double face_quality(const Points& p, const auto& t) {
  return triangle_quality(p.row(t[0]), p.row(t[1]), p.row(t[2]));
}

/// Per face the reference's normal, carried by its corners' rotations; not unit.
Points carried_normals(const Topology& topology, const Points& reference, const std::vector<Mat3>& rotations) {
  const Triangles& triangles = topology.triangles();
  Points carried(triangles.rows(), 3);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const auto t = triangles.row(f);
    const Vec3 normal = face_normal(reference, t);
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) sum += rotations[t[k]] * normal;
    carried.row(f) = sum.transpose();
  }
  return carried;
}

}  // namespace

std::vector<std::int32_t> turned_triangles(const Topology& topology, const Points& reference, const Points& points) {
  const Points carried = carried_normals(topology, reference, local_rotations(topology, reference, points));
  std::vector<std::int32_t> turned;
  for (Eigen::Index f = 0; f < carried.rows(); ++f) {
    if (carried.row(f).dot(face_normal(points, topology.triangles().row(f))) < 0) {
      turned.push_back(static_cast<std::int32_t>(f));
    }
  }
  return turned;
}

FoldGuard::FoldGuard(const Topology& topology, const Points& reference, const Points& start)
    : topology_(topology), reference_(reference), start_(start) {
  carried_ = carried_normals(topology, reference, local_rotations(topology, reference, start));
  const Triangles& triangles = topology.triangles();
  floor_.resize(triangles.rows());
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const auto t = triangles.row(f);
    const Vec3 carried = carried_.row(f).stableNormalized();
    const bool turned = carried.dot(face_normal(start, t)) <= 0;
    carried_.row(f) = turned ? Eigen::RowVector3d::Zero() : Eigen::RowVector3d(carried.transpose());
    floor_[f] = std::min(quality_floor, kept_share * face_quality(start, t));
  }
}

void FoldGuard::set_response(const VertexScalars& response) {
  response_ = response;
  reach_mm_ = usual_reach_mm;
  collect_strained();
}

void FoldGuard::collect_strained() {
  strained_.clear();
  const Triangles& triangles = topology_.triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const auto t = triangles.row(f);
    const double du1 = response_[t[1]] - response_[t[0]], du2 = response_[t[2]] - response_[t[0]];
    const double du3 = du2 - du1;
    const double strain = du1 * du1 + du2 * du2 + du3 * du3;
    if (strain < 1e-16) continue;
    const Vec3 m = carried_.row(f);
    if (m.isZero(0)) continue;  // turned already: nothing to keep
    const Vec3 a = start_.row(t[0]), b = start_.row(t[1]), c = start_.row(t[2]);
    const Vec3 e1 = b - a, e2 = c - a, e3 = c - b;
    const double area = m.dot(e1.cross(e2));  // twice the area as seen along the carried normal
    const double edges = e1.squaredNorm() + e2.squaredNorm() + e3.squaredNorm();
    if (area <= 1e-12 * edges) continue;  // degenerate already
    // The projected area never exceeds the true one, so holding the floor with it holds it, and keeps it positive.
    const double floor = std::min(floor_[f], kept_share * shape_factor * area / edges) / shape_factor;
    const Strained s{area - floor * edges, floor * strain,
                     m.cross(du2 * e1 - du1 * e2) - 2 * floor * (du1 * e1 + du2 * e2 + du3 * e3)};
    const double worst = s.slope.cwiseAbs().sum() + s.bend * reach_mm_;  // no direction is worse, a mm
    if (s.c0 < worst * reach_mm_) strained_.push_back(s);
  }
}

double FoldGuard::largest_step(const Vec3& d) {
  const double length = d.norm();
  if (length > reach_mm_) {
    reach_mm_ = 2 * length;
    collect_strained();
  }
  double step = 1;
  for (const Strained& s : strained_) {
    const double slope = s.slope.dot(d), bend = s.bend * length * length;
    if (s.c0 + step * (slope - step * bend) >= 0) continue;
    // Positive root of c0 + slope·t − bend·t² = 0, in the form without cancellation.
    const double root = std::sqrt(slope * slope + 4 * bend * s.c0);
    step = std::min(step, 2 * s.c0 / (root - slope));
  }
  return step;
}

double FoldGuard::accepted_step(double longest, const std::function<Points(double)>& at) const {
  constexpr double shortest = 1e-3;
  constexpr int most_halvings = 64;
  double step = longest;
  for (int halvings = 0; halvings < most_halvings && step > shortest; ++halvings, step /= 2)
    if (accepts(at(step))) return step;
  return 0;
}

bool FoldGuard::accepts(const Points& points) const {
  const Points carried = carried_normals(topology_, reference_, local_rotations(topology_, reference_, points));
  const Triangles& triangles = topology_.triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const auto t = triangles.row(f);
    if (!carried_.row(f).isZero(0) && carried.row(f).dot(face_normal(points, t)) < 0) return false;
    if (face_quality(points, t) < floor_[f] * (1 - 1e-9)) return false;
  }
  return true;
}

}  // namespace homolog
