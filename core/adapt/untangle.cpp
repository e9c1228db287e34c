#include "core/adapt/untangle.h"

#include <algorithm>
#include <set>
#include <vector>

#include "core/deform/fold_guard.h"
#include "core/deform/local_rotations.h"
#include "core/mesh/mesh_quality.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

constexpr int most_untangle_rounds = 10;
constexpr int rotation_rounds = 5;
constexpr double untangling_weight = 1e-4;  ///< weight of the force that keeps a freed vertex where it is

std::set<std::int32_t> tangled_vertices(const Mesh& mesh, const Points& reference) {
  std::set<std::int32_t> faces;
  for (const std::int32_t f : turned_triangles(*mesh.topology, reference, mesh.points)) faces.insert(f);
  for (const auto& pair : self_intersections(mesh)) faces.insert(pair.begin(), pair.end());
  std::set<std::int32_t> vertices;
  for (const std::int32_t f : faces)
    for (int k = 0; k < 3; ++k) vertices.insert(mesh.topology->triangles()(f, k));
  return vertices;
}

std::set<std::int32_t> grown(const Topology& topology, const std::set<std::int32_t>& patch) {
  std::set<std::int32_t> larger = patch;
  for (const std::int32_t v : patch) larger.insert(topology.one_ring(v).begin(), topology.one_ring(v).end());
  return larger;
}

}  // namespace

bool untangle(Mesh& mesh, const Points& reference, const VertexScalars& factors) {
  auto tangled = tangled_vertices(mesh, reference);
  if (tangled.empty()) return true;
  const Topology& topology = *mesh.topology;
  ShapeSolver solver(mesh.topology);
  std::set<std::int32_t> freed;
  for (int round = 0; round < most_untangle_rounds && !tangled.empty(); ++round) {
    freed.insert(tangled.begin(), tangled.end());
    freed = grown(topology, freed);
    VertexScalars weights = VertexScalars::Constant(mesh.points.rows(), 1 / untangling_weight);
    for (const std::int32_t v : freed) weights[v] = 1;
    // Soft against the forces around the patch, stiff against those within.
    const VertexScalars w = factors / untangling_weight * 1e-2;
    if (!solver.factorise(w, (weights.array() - 1).matrix())) return false;
    // First without rotations, which the tangle has spoilt; then as the reference has it, turned with the shape.
    const Points held = weights.asDiagonal() * mesh.points;
    const auto upright = std::vector<Mat3>(static_cast<std::size_t>(mesh.points.rows()), Mat3::Identity());
    mesh.points = solver.solve(Points(held + rotated_reference_force(topology, w, reference, upright)));
    for (int k = 0; k < rotation_rounds; ++k)
      mesh.points = solver.solve(Points(
          held + rotated_reference_force(topology, w, reference, local_rotations(topology, reference, mesh.points))));
    tangled = tangled_vertices(mesh, reference);
  }
  return tangled.empty();
}

Points without_turning(const Topology& topology, const Points& placed, const Points& from, const Points& to) {
  constexpr int rounds = 12;
  const auto before = turned_triangles(topology, placed, from);
  VertexScalars share = VertexScalars::Ones(from.rows());
  Points points = to;
  for (int round = 0; round < rounds; ++round) {
    std::set<std::int32_t> patch;
    for (const std::int32_t face : turned_triangles(topology, placed, points)) {
      if (std::binary_search(before.begin(), before.end(), face)) continue;
      for (const std::int32_t v : topology.triangles().row(face))
        patch.insert(topology.one_ring(v).begin(), topology.one_ring(v).end());
    }
    if (patch.empty()) return points;
    for (const std::int32_t v : patch) share[v] *= 0.5;
    points = from + share.asDiagonal() * (to - from);
  }
  return from;
}

}  // namespace homolog
