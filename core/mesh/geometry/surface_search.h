#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// A point on a triangulated surface: face and barycentric weights of its three corners (≥ 0, sum 1).
struct SurfacePoint {
  std::int32_t face = 0;
  Vec3 weights = Vec3(1, 0, 0);

  /// Value at the point of something given per vertex.
  template <class Derived>
  auto interpolate(const Topology& topology, const Eigen::MatrixBase<Derived>& per_vertex) const {
    const auto t = topology.triangles().row(face);
    return (weights[0] * per_vertex.row(t[0]) + weights[1] * per_vertex.row(t[1]) + weights[2] * per_vertex.row(t[2]))
        .eval();
  }
  bool operator==(const SurfacePoint&) const = default;
};

/// Whether a point lies on a boundary loop of the surface.
inline bool on_rim(const Topology& topology, const SurfacePoint& at) {
  constexpr double nothing = 1e-9;
  const auto t = topology.triangles().row(at.face);
  for (int c = 0; c < 3; ++c)
    if (at.weights[c] > nothing && !topology.on_rim(t[c])) return false;
  return true;
}

/// Bounding-volume hierarchy over the faces of one shape. It keeps a copy of the points as they were at construction
/// (or at the last refit).
class SurfaceSearch {
 public:
  explicit SurfaceSearch(const Mesh& mesh);
  /// Takes new points of the same topology; keeps the tree, recomputes its boxes.
  void refit(const Points& points);

  struct Nearest {
    SurfacePoint at;
    Vec3 position = Vec3::Zero();
    double distance_mm = 0;
  };
  /// The surface point nearest to `p`, exactly. A face that is likely to be near (the answer for a neighbouring point)
  /// makes it faster and changes nothing else but which of several equally near faces is named.
  Nearest nearest(const Vec3& p, std::int32_t likely_face = 0) const;
  /// First hit of the ray `from + t · direction`, t ≥ 0 (direction need not be unit), either side of a face.
  std::optional<Nearest> first_hit(const Vec3& from, const Vec3& direction) const;
  /// Calls `visit(f, g)` once for each two faces f < g whose boxes meet, until it gives false. All in one walk through
  /// the tree, which takes less time than to ask for every face.
  void for_each_near_pair(const std::function<bool(std::int32_t, std::int32_t)>& visit) const;

  const Mesh& mesh() const { return mesh_; }

 private:
  struct Node {
    Box box;
    /// Leaf: faces order_[first, first + count). Inner: children `first` and `first` + 1, count 0.
    std::int32_t first = 0, count = 0;
  };
  void compute_boxes();
  std::int32_t face_in(const Node& leaf, std::int32_t i) const;
  std::array<Vec3, 3> corners(std::int32_t face) const;
  Box face_box(std::int32_t face) const;
  Nearest at(std::int32_t face, const Vec3& weights, const Vec3& p) const;

  Mesh mesh_;
  std::vector<Node> nodes_;  ///< children after their parents
  std::vector<std::int32_t> order_;
};

/// Returns the nearest place on a surface for each of the points, n×3 like these, mm.
Points closest_places(const Mesh& surface, const Points& points);

/// The surface point nearest to `p`, exactly, found by looking at every face: for one question, which is much less work
/// than making a search.
SurfaceSearch::Nearest nearest_on_surface(const Topology& topology, const Points& points, const Vec3& p);

/// The point of triangle (a, b, c) nearest to `p`, as barycentric weights.
Vec3 nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace homolog
