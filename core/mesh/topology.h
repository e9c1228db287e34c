#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"

namespace homolog {

class EliminationPlan;

/// The connectivity of a manifold, consistently oriented triangle mesh, immutable and shared by every shape that has
/// it. Vertex order and count are those given.
class Topology {
 public:
  /// Refuses: no faces, an index out of range, a face that names a vertex twice, an edge with more than two faces or
  /// with two faces of opposite orientation, a vertex whose faces do not form one fan, a vertex of no face. The error's
  /// sentence names the first offender and the remedy.
  static Result<std::shared_ptr<const Topology>> make(Eigen::Index vertices, Triangles triangles);

  Eigen::Index vertices() const { return vertices_; }
  const Triangles& triangles() const { return triangles_; }
  /// e×2 vertex indices, each edge once, lower index first, sorted.
  const std::vector<std::array<std::int32_t, 2>>& edges() const { return edges_; }
  /// The vertices joined to `vertex` by an edge: its one-ring N(i), ascending.
  std::span<const std::int32_t> one_ring(Eigen::Index vertex) const {
    return {ring_.data() + ring_start_[vertex], ring_.data() + ring_start_[static_cast<std::size_t>(vertex) + 1]};
  }
  /// The faces around `vertex`.
  std::span<const std::int32_t> faces_of(Eigen::Index vertex) const {
    return {faces_.data() + face_start_[vertex], faces_.data() + face_start_[static_cast<std::size_t>(vertex) + 1]};
  }
  /// The face across each edge of `face`: entry k is across the edge from corner k to corner k+1; −1 at a boundary.
  const std::array<std::int32_t, 3>& neighbours(Eigen::Index face) const { return neighbours_[face]; }
  /// Each boundary loop as vertices in the direction of its faces' edges; empty for a closed mesh.
  const std::vector<std::vector<std::int32_t>>& rims() const { return rims_; }
  bool closed() const { return rims_.empty(); }
  bool on_rim(Eigen::Index vertex) const { return on_rim_[vertex] != 0; }
  /// Connected component (sheet) of each vertex, numbered from 0 by first vertex.
  const std::vector<std::int32_t>& component() const { return component_; }
  int components() const { return components_; }
  /// Sum of the components' genera, boundary loops counted as capped: (2·components − V + E − F − loops) / 2.
  int genus() const;
  /// 16 hex digits over the triangles: equal exactly when two meshes have the same numbering and faces.
  const std::string& hash() const { return hash_; }

  /// Room for what core/solve makes once of a connectivity and keeps with it [elimination_plan.h].
  struct PlanKept {
    std::mutex mutex;
    std::shared_ptr<const EliminationPlan> plan;
  };
  PlanKept& plan_kept() const { return *plan_kept_; }

 private:
  Topology() = default;
  void gather_faces();
  Result<void> join_faces();
  std::size_t fan_size(std::int32_t vertex) const;  ///< faces reached by turning around `vertex` from its first face
  Result<void> check_fans() const;
  void gather_rings();
  void trace_boundary();
  void number_components();

  Eigen::Index vertices_ = 0;
  Triangles triangles_;
  std::vector<std::array<std::int32_t, 2>> edges_;
  std::vector<std::size_t> ring_start_, face_start_;
  std::vector<std::int32_t> ring_, faces_;
  std::vector<std::array<std::int32_t, 3>> neighbours_;
  std::vector<std::vector<std::int32_t>> rims_;
  std::vector<char> on_rim_;
  std::vector<std::int32_t> component_;
  int components_ = 0;
  std::string hash_;
  std::shared_ptr<PlanKept> plan_kept_ = std::make_shared<PlanKept>();
};

/// A shape: points over a shared connectivity.
struct Mesh {
  std::shared_ptr<const Topology> topology;
  Points points;  ///< topology->vertices() × 3, LPS mm
};

}  // namespace homolog
