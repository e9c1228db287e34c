#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/topology.h"

/// Small shapes with known properties, made in code, for every test.
namespace homolog::shapes {

inline Mesh make_mesh(const std::vector<Vec3>& points, const std::vector<std::array<std::int32_t, 3>>& faces) {
  Mesh mesh;
  mesh.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) mesh.points.row(static_cast<Eigen::Index>(i)) = points[i];
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    triangles.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  mesh.topology = Topology::make(mesh.points.rows(), std::move(triangles)).value();
  return mesh;
}

/// The corners (0,0,0), (1,0,0), (0,1,0), (0,0,1) times `size_mm`.
inline Mesh tetrahedron(double size_mm = 1) {
  return make_mesh({{0, 0, 0}, {size_mm, 0, 0}, {0, size_mm, 0}, {0, 0, size_mm}},
                   {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

/// Axis-aligned box of 8 corners and 12 faces; corner i has bits x, y, z.
inline Mesh box(const Vec3& low = Vec3::Zero(), const Vec3& high = Vec3::Ones()) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i)
    points.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  return make_mesh(points, {{0, 2, 1},
                            {1, 2, 3},
                            {4, 5, 6},
                            {5, 7, 6},
                            {0, 1, 4},
                            {1, 5, 4},
                            {2, 6, 3},
                            {3, 6, 7},
                            {0, 4, 2},
                            {2, 4, 6},
                            {1, 3, 5},
                            {3, 7, 5}});
}

/// Torus around the z axis; vertex (ring, sector) has index ring · sectors + sector.
inline Mesh torus(int rings, int sectors, double major_mm = 2, double minor_mm = 1) {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> faces;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const double u = 2 * std::numbers::pi * r / rings, v = 2 * std::numbers::pi * s / sectors;
      const double w = major_mm + minor_mm * std::cos(v);
      points.emplace_back(w * std::cos(u), w * std::sin(u), minor_mm * std::sin(v));
      const int r1 = (r + 1) % rings, s1 = (s + 1) % sectors;
      const int a = r * sectors + s, b = r1 * sectors + s, c = r1 * sectors + s1, d = r * sectors + s1;
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    }
  }
  return make_mesh(points, faces);
}

/// Tube around the z axis from z = 0 to `height_mm`, open at both ends; vertex (ring, sector) as in torus().
inline Mesh open_cylinder(int rings, int sectors, double radius_mm = 1, double height_mm = 2) {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> faces;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const double v = 2 * std::numbers::pi * s / sectors;
      points.emplace_back(radius_mm * std::cos(v), radius_mm * std::sin(v), height_mm * r / (rings - 1));
      if (r + 1 == rings) continue;
      const int s1 = (s + 1) % sectors;
      const int a = r * sectors + s, b = r * sectors + s1, c = (r + 1) * sectors + s1, d = (r + 1) * sectors + s;
      faces.push_back({a, b, c});
      faces.push_back({a, c, d});
    }
  }
  return make_mesh(points, faces);
}

constexpr double ridge_mm = 35;  ///< along z

/// A long organ with a ridge around its shaft: an ellipsoid of 20 × 20 × 60 mm half axes, turned by `turn_rad` around
/// x, the more so the farther up.
inline Mesh shaft_with_ridge(double turn_rad, int subdivisions = 5) {
  Mesh shaft = icosphere(subdivisions, 20);
  for (auto p : shaft.points.rowwise()) {
    p.z() *= 3;
    const double from_ridge_mm = p.z() - ridge_mm;
    p.leftCols<2>() *= 1 + 0.3 * std::exp(-from_ridge_mm * from_ridge_mm / (2 * 5 * 5));
    const double turn = turn_rad * (p.z() + 60) / 120;
    p = (Eigen::AngleAxisd(turn, Vec3::UnitX()) * p.transpose()).transpose().eval();
  }
  return shaft;
}

/// How far apart two n×3 lie near the ridge of the `upright` shaft: root mean square, mm.
inline double apart_at_ridge_mm(const Mesh& upright, const Points& a, const Points& b) {
  double sum_mm2 = 0, count = 0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (std::abs(upright.points(i, 2) - ridge_mm) > 8) continue;
    sum_mm2 += (a.row(i) - b.row(i)).squaredNorm();
    ++count;
  }
  return std::sqrt(sum_mm2 / count);
}

/// The vertices of a mesh shifted, and back onto its surface where that is nearest.
inline Points slid_along(const Mesh& mesh, const Vec3& shift_mm) {
  Points slid = mesh.points.rowwise() + shift_mm.transpose();
  const SurfaceSearch search(mesh);
  for (Eigen::Index i = 0; i < slid.rows(); ++i) slid.row(i) = search.nearest(slid.row(i).transpose()).position;
  return slid;
}

}  // namespace homolog::shapes

namespace homolog {

/// Largest difference of a coordinate.
inline double largest_difference(const Points& a, const Points& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

/// Mean distance of equal landmarks, mm.
inline double mean_distance(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().mean();
}

}  // namespace homolog
