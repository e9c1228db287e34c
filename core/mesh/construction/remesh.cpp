#include "core/mesh/construction/remesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace homolog {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using OpenMesh::Vec3d;

/// Onto the surface, and onto its rims.
struct SurfaceProjection {
  const Projection &surface, &rim;
};

HalfEdgeMesh half_edges_of(const Mesh& mesh) {
  HalfEdgeMesh result;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    result.add_vertex(Vec3d(mesh.points(i, 0), mesh.points(i, 1), mesh.points(i, 2)));
  const Triangles& triangles = mesh.topology->triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    result.add_face(result.vertex_handle(static_cast<unsigned>(triangles(f, 0))),
                    result.vertex_handle(static_cast<unsigned>(triangles(f, 1))),
                    result.vertex_handle(static_cast<unsigned>(triangles(f, 2))));
  return result;
}

Mesh mesh_of(HalfEdgeMesh& half_edges) {
  half_edges.garbage_collection();
  Mesh mesh;
  mesh.points.resize(static_cast<Eigen::Index>(half_edges.n_vertices()), 3);
  for (const auto v : half_edges.vertices())
    for (int axis = 0; axis < 3; ++axis) mesh.points(v.idx(), axis) = half_edges.point(v)[static_cast<unsigned>(axis)];
  Triangles triangles(static_cast<Eigen::Index>(half_edges.n_faces()), 3);
  for (const auto f : half_edges.faces()) {
    int corner = 0;
    for (const auto v : f.vertices()) triangles(f.idx(), corner++) = v.idx();
  }
  auto topology = Topology::make(mesh.points.rows(), std::move(triangles));
  assert(topology && "splits, collapses and flips keep a manifold manifold, and its rims");
  mesh.topology = *topology;
  return mesh;
}

void split_long_edges(HalfEdgeMesh& mesh, double limit_mm) {
  const auto edges = static_cast<int>(mesh.n_edges());  // edges made here are not looked at again in this round
  for (int e = 0; e < edges; ++e) {
    const OpenMesh::EdgeHandle edge(e);
    if (mesh.calc_edge_length(edge) > limit_mm) mesh.split(edge, mesh.calc_edge_midpoint(edge));
  }
}

/// Whether moving `vertex` to `target` turns none of its faces except those at `other`, which vanish, and leaves none
/// of its edges longer than `limit_mm`.
bool may_move(const HalfEdgeMesh& mesh, HalfEdgeMesh::VertexHandle vertex, HalfEdgeMesh::VertexHandle other,
              const Vec3d& target, double limit_mm) {
  for (const auto h : mesh.voh_range(vertex)) {
    const auto a = h.to(), b = h.next().to();
    if ((mesh.point(a) - target).norm() > limit_mm) return false;
    if (h.is_boundary() || a == other || b == other) continue;
    const Vec3d pa = mesh.point(a), pb = mesh.point(b);
    const Vec3d before = (pa - mesh.point(vertex)).cross(pb - mesh.point(vertex));
    const Vec3d after = (pa - target).cross(pb - target);
    if (before.dot(after) < 0.5 * before.norm() * after.norm()) return false;
  }
  return true;
}

/// Makes one vertex of an edge's two, in its middle, or on the rim where one of them is of the rim; false where that
/// would fold the surface, change its topology or make an edge longer than `limit_mm`.
bool collapse(HalfEdgeMesh& mesh, OpenMesh::EdgeHandle edge, double limit_mm) {
  auto h = mesh.halfedge_handle(edge, 0);
  if (mesh.is_boundary(mesh.from_vertex_handle(h))) h = mesh.opposite_halfedge_handle(h);
  const auto from = mesh.from_vertex_handle(h), to = mesh.to_vertex_handle(h);
  const bool to_rim = mesh.is_boundary(to) && !mesh.is_boundary(from);
  const Vec3d middle = to_rim ? Vec3d(mesh.point(to)) : mesh.calc_edge_midpoint(edge);
  if (!mesh.is_collapse_ok(h) || !may_move(mesh, from, to, middle, limit_mm) ||
      !may_move(mesh, to, from, middle, limit_mm))
    return false;
  mesh.collapse(h);
  mesh.set_point(to, middle);
  return true;
}

void collapse_short_edges(HalfEdgeMesh& mesh, double least_mm, double limit_mm) {
  for (int e = 0; e < static_cast<int>(mesh.n_edges()); ++e) {
    const OpenMesh::EdgeHandle edge(e);
    if (!mesh.status(edge).deleted() && mesh.calc_edge_length(edge) < least_mm) collapse(mesh, edge, limit_mm);
  }
  mesh.garbage_collection();
}

/// Flips edges where that brings the valences nearer to six (four on a rim), unless the surface would fold there.
void even_valences(HalfEdgeMesh& mesh) {
  const auto excess = [&](HalfEdgeMesh::VertexHandle v, int change) {
    return std::abs(static_cast<int>(mesh.valence(v)) + change - (mesh.is_boundary(v) ? 4 : 6));
  };
  for (const auto edge : mesh.edges()) {
    if (!mesh.is_flip_ok(edge)) continue;
    const auto h = edge.h0(), opposite = edge.h1();
    const auto a = h.from(), b = h.to(), c = h.next().to(), d = opposite.next().to();
    const int now = excess(a, 0) + excess(b, 0) + excess(c, 0) + excess(d, 0);
    const int then = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1);
    if (then >= now) continue;
    const Vec3d pa = mesh.point(a), pb = mesh.point(b), pc = mesh.point(c), pd = mesh.point(d);
    const Vec3d old_normal = (pb - pa).cross(pc - pa).normalized() + (pa - pb).cross(pd - pb).normalized();
    const Vec3d new_c = (pc - pd).cross(pa - pd), new_d = (pb - pd).cross(pc - pd);
    const double worst_cosine = 0.5;
    if (new_c.dot(old_normal) < worst_cosine * new_c.norm() * old_normal.norm() ||
        new_d.dot(old_normal) < worst_cosine * new_d.norm() * old_normal.norm())
      continue;
    mesh.flip(edge);
  }
}

/// Half way from a vertex of a rim to the middle between its neighbours there: a whole step would swing to and fro.
Vec3d relaxed_on_rim(const HalfEdgeMesh& mesh, HalfEdgeMesh::VertexHandle v) {
  const auto out = mesh.halfedge_handle(v);  // on the rim where the vertex is
  const Vec3d after = mesh.point(mesh.to_vertex_handle(out)),
              before = mesh.point(mesh.from_vertex_handle(mesh.prev_halfedge_handle(out)));
  return 0.5 * mesh.point(v) + 0.25 * (before + after);
}

/// Every vertex to the area-weighted centre of the faces around it, along the surface only, then back onto it. One of a
/// rim goes along the rim.
void relax_tangentially(HalfEdgeMesh& mesh, const SurfaceProjection& project) {
  std::vector<Vec3d> moved(mesh.n_vertices());
  for (const auto v : mesh.vertices()) {
    if (mesh.is_boundary(v)) {
      moved[v.idx()] = relaxed_on_rim(mesh, v);
      continue;
    }
    Vec3d normal(0, 0, 0), centre(0, 0, 0);
    double area = 0;
    for (const auto f : v.faces()) {
      const Vec3d face_normal = mesh.calc_face_normal(f) * mesh.calc_face_area(f);
      normal += face_normal;
      centre += mesh.calc_face_centroid(f) * face_normal.norm();
      area += face_normal.norm();
    }
    const Vec3d step = centre / area - mesh.point(v);
    normal.normalize();
    moved[v.idx()] = mesh.point(v) + step - normal * normal.dot(step);
  }
  for (const auto v : mesh.vertices()) {
    const Vec3d& p = moved[v.idx()];
    const Vec3 at(p[0], p[1], p[2]), on_surface = mesh.is_boundary(v) ? project.rim(at) : project.surface(at);
    mesh.set_point(v, Vec3d(on_surface.x(), on_surface.y(), on_surface.z()));
  }
}

void one_round(HalfEdgeMesh& mesh, double edge_mm, const SurfaceProjection& project) {
  split_long_edges(mesh, edge_mm * 4 / 3);
  collapse_short_edges(mesh, edge_mm * 4 / 5, edge_mm * 4 / 3);
  even_valences(mesh);
  relax_tangentially(mesh, project);
}

/// The count is settled; only the spread still improves.
void spread_evenly(HalfEdgeMesh& mesh, const SurfaceProjection& project, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    even_valences(mesh);
    relax_tangentially(mesh, project);
  }
}

/// Edges by length, from the longest or from the shortest.
std::vector<OpenMesh::EdgeHandle> edges_by_length(const HalfEdgeMesh& mesh, bool longest_first) {
  std::vector<std::pair<double, int>> order;
  for (const auto edge : mesh.edges()) {
    const double length = mesh.calc_edge_sqr_length(edge);
    order.emplace_back(longest_first ? -length : length, edge.idx());
  }
  std::sort(order.begin(), order.end());
  std::vector<OpenMesh::EdgeHandle> edges;
  for (const auto& [length, edge] : order) edges.emplace_back(edge);
  return edges;
}

/// Splits the longest or collapses the shortest edges until there are `vertices`.
void settle_count(HalfEdgeMesh& mesh, std::size_t vertices) {
  if (mesh.n_vertices() < vertices) {
    for (const auto edge : edges_by_length(mesh, true)) {
      if (mesh.n_vertices() == vertices) break;
      mesh.split(edge, mesh.calc_edge_midpoint(edge));
    }
  } else {
    std::size_t excess = mesh.n_vertices() - vertices;
    const double no_limit_mm = std::numeric_limits<double>::infinity();
    for (const auto edge : edges_by_length(mesh, false)) {
      if (excess == 0) break;
      if (!mesh.status(edge).deleted() && collapse(mesh, edge, no_limit_mm)) --excess;
    }
    mesh.garbage_collection();
  }
}

}  // namespace

double spread_edge_mm(double area_mm2, Eigen::Index vertices) {
  return std::sqrt(area_mm2 * 2 / (std::sqrt(3.0) * static_cast<double>(vertices)));
}

Mesh remesh_to_count(const Mesh& mesh, int vertices, const Projection& project_surface, Progress* progress,
                     const Projection& project_rim) {
  assert((mesh.topology->closed() || project_rim) && vertices >= 4);
  const SurfaceProjection project{project_surface, project_rim};
  const auto wanted = static_cast<std::size_t>(vertices);
  HalfEdgeMesh half_edges = half_edges_of(mesh);
  double area_mm2 = 0;
  for (const auto f : half_edges.faces()) area_mm2 += half_edges.calc_face_area(f);
  double edge_mm = spread_edge_mm(area_mm2, vertices);
  const int attempts = 8;
  for (int attempt = 0; attempt < attempts && !(progress && progress->cancelled()); ++attempt) {
    for (int round = 0; round < (attempt == 0 ? 6 : 3); ++round) one_round(half_edges, edge_mm, project);
    const double surplus = static_cast<double>(half_edges.n_vertices()) / static_cast<double>(wanted);
    if (progress) progress->report(1.0 * (attempt + 1) / attempts);
    if (std::abs(surplus - 1) < 0.01) break;
    edge_mm *= std::sqrt(surplus);
  }
  settle_count(half_edges, wanted);
  spread_evenly(half_edges, project, 30);
  return mesh_of(half_edges);
}

}  // namespace homolog
