#include "core/mesh/repair/mesh_faults.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "core/base/text/listed.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double flat_deg = 1;
constexpr double against = -0.5;  ///< cosine between a face's normal and the mean one around it

/// Faces whose normal points against that of the faces around.
std::vector<std::int32_t> turned_faces(const Mesh& mesh) {
  const Triangles& triangles = mesh.topology->triangles();
  Points around = Points::Zero(mesh.points.rows(), 3);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    for (int k = 0; k < 3; ++k) around.row(triangles(f, k)) += area_normal(mesh, f).transpose();
  std::vector<std::int32_t> turned;
  for (std::int32_t f = 0; f < triangles.rows(); ++f) {
    const Vec3 own = area_normal(mesh, f);
    Vec3 others = -3 * own;
    for (int k = 0; k < 3; ++k) others += around.row(triangles(f, k)).transpose();
    if (own.dot(others) < against * own.norm() * others.norm()) turned.push_back(f);
  }
  return turned;
}

std::vector<std::int32_t> thin_faces(const Mesh& mesh) {
  std::vector<std::int32_t> flat;
  for (std::int32_t f = 0; f < mesh.topology->triangles().rows(); ++f)
    if (smallest_angle_deg(mesh, f) < flat_deg) flat.push_back(f);
  return flat;
}

}  // namespace

std::string MeshFaults::words() const {
  std::vector<std::string> parts;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) parts.push_back(count == 1 ? "one " + one : std::to_string(count) + " " + many);
  };
  add(intersections, "pair of faces that cut each other", "pairs of faces that cut each other");
  if (!all_intersections)
    parts = {intersections > 0 ? "at least " + parts.front()
                               : "so many faces close to each other that not all could be compared"};
  add(turned, "face that is turned over", "faces that are turned over");
  add(flat, "face with an angle below 1°", "faces with an angle below 1°");
  return listed(parts, " and ");
}

MeshFaults mesh_faults(const Mesh& mesh) {
  MeshFaults faults;
  const SelfIntersections intersections = find_self_intersections(mesh);
  faults.intersections = intersections.pairs.size();
  faults.all_intersections = intersections.all;
  faults.turned = turned_faces(mesh).size();
  faults.flat = thin_faces(mesh).size();
  faults.tunnels = mesh.topology->genus();
  return faults;
}

std::vector<std::int32_t> faulty_faces(const Mesh& mesh) {
  std::vector<std::int32_t> faces = turned_faces(mesh), flat = thin_faces(mesh);
  faces.insert(faces.end(), flat.begin(), flat.end());
  for (const auto& [a, b] : self_intersections(mesh)) faces.insert(faces.end(), {a, b});
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

void smooth_faults(Mesh& mesh) {
  constexpr int most_rounds = 20;
  constexpr double most_faulty_share = 0.005;
  constexpr double step = 0.3;
  const Triangles& triangles = mesh.topology->triangles();
  std::vector<std::int32_t> faulty = faulty_faces(mesh);
  if (static_cast<double>(faulty.size()) > most_faulty_share * static_cast<double>(triangles.rows())) return;
  Mesh smooth = mesh;
  std::size_t fewest = faulty.size();
  for (int round = 0; round < most_rounds && fewest > 0; ++round) {
    std::set<std::int32_t> vertices;
    for (const std::int32_t face : faulty)
      for (int corner = 0; corner < 3; ++corner) vertices.insert(triangles(face, corner));
    Points moved = smooth.points;
    for (const std::int32_t v : vertices) {
      if (mesh.topology->on_rim(v)) continue;  // the rim would shrink
      Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
      const auto ring = mesh.topology->one_ring(v);
      for (const std::int32_t next : ring) middle += smooth.points.row(next) / static_cast<double>(ring.size());
      moved.row(v) += step * (middle - smooth.points.row(v));
    }
    smooth.points = std::move(moved);
    faulty = faulty_faces(smooth);
    if (faulty.size() >= fewest) continue;
    fewest = faulty.size();
    mesh.points = smooth.points;
  }
}

}  // namespace homolog
