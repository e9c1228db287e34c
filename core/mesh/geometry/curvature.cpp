#include "core/mesh/geometry/curvature.h"

#include <cmath>
#include <numbers>

#include "core/mesh/mesh_quality.h"

namespace homolog {

VertexScalars gaussian_curvature(const Mesh& mesh) {
  const Triangles& triangles = mesh.topology->triangles();
  VertexScalars curvature(mesh.points.rows()), area = VertexScalars::Zero(mesh.points.rows());
  for (Eigen::Index i = 0; i < curvature.size(); ++i)
    curvature[i] = (mesh.topology->on_rim(i) ? 1 : 2) * std::numbers::pi;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 at = mesh.points.row(triangles(f, k));
      const Vec3 u = Vec3(mesh.points.row(triangles(f, (k + 1) % 3))) - at;
      const Vec3 v = Vec3(mesh.points.row(triangles(f, (k + 2) % 3))) - at;
      const double twice_area = u.cross(v).norm();
      curvature[triangles(f, k)] -= std::atan2(twice_area, u.dot(v));
      area[triangles(f, k)] += twice_area / 2;
    }
  }
  return (area.array() > 0).select(3 * curvature.array() / area.array(), 0.0);
}

VertexScalars mean_curvature(const Mesh& mesh) {
  const Topology& topology = *mesh.topology;
  const Triangles& triangles = topology.triangles();
  VertexScalars sum = VertexScalars::Zero(mesh.points.rows()), area = sum;
  const auto at = [&](std::int32_t v) { return Vec3(mesh.points.row(v)); };
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Vec3 normal = area_normal(mesh, f);
    for (int k = 0; k < 3; ++k) {
      area[triangles(f, k)] += normal.norm() / 2;
      const std::int32_t across = topology.neighbours(f)[k];
      if (across < f) continue;  // every edge once; none at a boundary
      const Vec3 other = area_normal(mesh, across);
      const Vec3 edge = at(triangles(f, (k + 1) % 3)) - at(triangles(f, k));
      // Positive where the normals part: the turn from one face to the next around the edge.
      const double turn = std::atan2(normal.cross(other).dot(edge.normalized()), normal.dot(other));
      for (const int end : {k, (k + 1) % 3}) sum[triangles(f, end)] += edge.norm() * turn / 4;
    }
  }
  VertexScalars curvature = (area.array() > 0).select(3 * sum.array() / area.array(), 0.0);
  for (Eigen::Index i = 0; i < curvature.size(); ++i)
    if (topology.on_rim(i)) curvature[i] = 0;
  return curvature;
}

}  // namespace homolog
