#include "core/mesh/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/numbers/index.h"
#include "core/mesh/parts/rims.h"

namespace homolog {
namespace {

Vec3 corner(const Mesh& mesh, Eigen::Index face, int k) {
  return mesh.points.row(mesh.topology->triangles()(face, k));
}

Vec3 centre_of(const std::vector<std::int32_t>& loop, const Points& points) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t v : loop) sum += points.row(v);
  return sum / static_cast<double>(loop.size());
}

void measure_edges(const Mesh& mesh, MeshQuality& quality) {
  const auto& edges = mesh.topology->edges();
  double sum = 0, squares = 0;
  quality.edge_min = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : edges) {
    const double length = (mesh.points.row(a) - mesh.points.row(b)).norm();
    sum += length;
    squares += length * length;
    quality.edge_min = std::min(quality.edge_min, length);
    quality.edge_max = std::max(quality.edge_max, length);
  }
  const auto count = static_cast<double>(edges.size());
  quality.edge_mean = sum / count;
  const double variance = std::max(0.0, squares / count - quality.edge_mean * quality.edge_mean);
  quality.edge_cv = quality.edge_mean > 0 ? std::sqrt(variance) / quality.edge_mean : 0;
}

double angle(const Vec3& u, const Vec3& v) {
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

Vec3 area_normal(const Mesh& mesh, Eigen::Index face) {
  const Vec3 a = corner(mesh, face, 0);
  return (corner(mesh, face, 1) - a).cross(corner(mesh, face, 2) - a);
}

double smallest_angle_deg(const Mesh& mesh, Eigen::Index face) {
  double smallest = std::numbers::pi;
  for (int k = 0; k < 3; ++k) {
    const Vec3 at = corner(mesh, face, k);
    smallest = std::min(smallest, angle(corner(mesh, face, (k + 1) % 3) - at, corner(mesh, face, (k + 2) % 3) - at));
  }
  return smallest * 180 / std::numbers::pi;
}

MeshQuality mesh_quality(const Mesh& mesh) {
  MeshQuality quality;
  measure_edges(mesh, quality);
  quality.min_angle_deg = 180;
  for (Eigen::Index f = 0; f < mesh.topology->triangles().rows(); ++f)
    quality.min_angle_deg = std::min(quality.min_angle_deg, smallest_angle_deg(mesh, f));
  quality.area_mm2 = surface_area_mm2(mesh);
  const Eigen::Index vertices = mesh.topology->vertices();
  quality.valence_min = static_cast<int>(vertices);
  for (Eigen::Index i = 0; i < vertices; ++i) {
    const auto valence = static_cast<int>(mesh.topology->one_ring(i).size());
    quality.valence_min = std::min(quality.valence_min, valence);
    quality.valence_max = std::max(quality.valence_max, valence);
    if (valence == 6) quality.regular_share += 1.0 / static_cast<double>(vertices);
  }
  const SelfIntersections intersections = find_self_intersections(mesh);
  quality.self_intersections = intersections.pairs.size();
  quality.all_intersections = intersections.all;
  quality.volume_ml = enclosed_volume_ml(mesh);
  return quality;
}

Points vertex_normals(const Mesh& mesh) {
  Points normals = Points::Zero(mesh.points.rows(), 3);
  const Triangles& triangles = mesh.topology->triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Vec3 normal = area_normal(mesh, f);
    for (int k = 0; k < 3; ++k) normals.row(triangles(f, k)) += normal.transpose();
  }
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    const double length = normals.row(i).norm();
    if (length > 0) normals.row(i) /= length;
  }
  return normals;
}

VertexScalars vertex_areas_mm2(const Mesh& mesh) {
  VertexScalars areas_mm2 = VertexScalars::Zero(mesh.points.rows());
  const Triangles& triangles = mesh.topology->triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    for (int k = 0; k < 3; ++k) areas_mm2[triangles(f, k)] += area_normal(mesh, f).norm() / 6;
  return areas_mm2;
}

Mesh largest_part(const Mesh& mesh) {
  if (mesh.topology->components() == 1) return mesh;
  const auto& part = mesh.topology->component();
  const Triangles& triangles = mesh.topology->triangles();
  const auto part_of = [&](Eigen::Index f) { return part[triangles(f, 0)]; };
  std::vector<double> area(index(mesh.topology->components()), 0);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) area[part_of(f)] += area_normal(mesh, f).norm();
  const auto largest = static_cast<std::int32_t>(std::max_element(area.begin(), area.end()) - area.begin());

  std::vector<std::int32_t> number(part.size(), -1), kept;
  for (std::size_t v = 0; v < part.size(); ++v)
    if (part[v] == largest) {
      number[v] = static_cast<std::int32_t>(kept.size());
      kept.push_back(static_cast<std::int32_t>(v));
    }
  Triangles faces(triangles.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    if (part_of(f) == largest)
      faces.row(count++) = triangles.row(f).unaryExpr([&](std::int32_t v) { return number[v]; });
  faces.conservativeResize(count, 3);
  Points points = mesh.points(kept, Eigen::all);
  return {Topology::make(points.rows(), std::move(faces)).value(), std::move(points)};
}

double surface_area_mm2(const Mesh& mesh) {
  double twice = 0;
  for (Eigen::Index f = 0; f < mesh.topology->triangles().rows(); ++f) twice += area_normal(mesh, f).norm();
  return twice / 2;
}

double enclosed_volume_ml(const Mesh& mesh) {
  // Tetrahedra from a point nearby: far from the origin they would cancel badly.
  const Vec3 apex = mesh.points.row(0);
  double six_volumes = 0;
  for (Eigen::Index f = 0; f < mesh.topology->triangles().rows(); ++f)
    six_volumes += area_normal(mesh, f).dot(corner(mesh, f, 0) - apex);
  for (const auto& loop : mesh.topology->rims()) {
    const Vec3 centre = centre_of(loop, mesh.points);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 a = mesh.points.row(loop[(i + 1) % loop.size()]), b = mesh.points.row(loop[i]);
      six_volumes += (a - apex).cross(b - apex).dot(centre - apex);
    }
  }
  return six_volumes / 6 / 1000;
}

Mesh capped(const Mesh& mesh, double longest_mm) {
  std::vector<std::vector<std::int32_t>> loops;
  for (const auto& loop : mesh.topology->rims())
    if (rim_length_mm(loop, mesh.points) <= longest_mm) loops.push_back(loop);
  if (loops.empty()) return mesh;
  const Eigen::Index vertices = mesh.points.rows(), faces = mesh.topology->triangles().rows();
  Eigen::Index rim = 0;
  for (const auto& loop : loops) rim += static_cast<Eigen::Index>(loop.size());

  Points points(vertices + static_cast<Eigen::Index>(loops.size()), 3);
  points.topRows(vertices) = mesh.points;
  Triangles triangles(faces + rim, 3);
  triangles.topRows(faces) = mesh.topology->triangles();
  Eigen::Index face = faces, centre = vertices;
  for (const auto& loop : loops) {
    points.row(centre) = centre_of(loop, mesh.points);
    for (std::size_t i = 0; i < loop.size(); ++i)
      triangles.row(face++) << loop[(i + 1) % loop.size()], loop[i], static_cast<std::int32_t>(centre);
    ++centre;
  }
  return {Topology::make(points.rows(), std::move(triangles)).value(), std::move(points)};
}

double mean_edge_mm(const Topology& topology, const Points& points) {
  double sum = 0;
  for (const auto& [a, b] : topology.edges()) sum += (points.row(a) - points.row(b)).norm();
  return sum / static_cast<double>(topology.edges().size());
}

double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return squares > 0 ? 2 * std::numbers::sqrt3 * (b - a).cross(c - a).norm() / squares : 0;
}

}  // namespace homolog
