#include "core/measure/surface_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace homolog {

namespace {

constexpr int places_an_edge = 3;

/// A place on an edge that a way crosses.
struct EdgeCrossing {
  std::int32_t edge = 0;
  double share = 0;  ///< 0 at the edge's first vertex, 1 at its second
};

/// The faces that a point lies in: one, the two of an edge, or all around a vertex.
std::vector<std::int32_t> faces_at(const Topology& topology, const SurfacePoint& point) {
  constexpr double none = 1e-12;
  const auto corners = topology.triangles().row(point.face);
  for (int k = 0; k < 3; ++k)
    if (point.weights[(k + 1) % 3] <= none && point.weights[(k + 2) % 3] <= none) {
      const auto around = topology.faces_of(corners[k]);
      return {around.begin(), around.end()};
    }
  std::vector<std::int32_t> faces{point.face};
  for (int k = 0; k < 3; ++k)  // edge k is opposite to corner k + 2
    if (point.weights[(k + 2) % 3] <= none)
      if (const std::int32_t other = topology.neighbours(point.face)[k]; other >= 0) faces.push_back(other);
  return faces;
}

/// Looks for a way over places on the edges, nearest first.
class PathSearch {
 public:
  PathSearch(const Mesh& mesh, const SurfacePoint& from, const SurfacePoint& to)
      : mesh_(mesh),
        topology_(*mesh.topology),
        start_faces_(faces_at(topology_, from)),
        end_faces_(faces_at(topology_, to)),
        start_(from.interpolate(topology_, mesh.points).transpose()),
        end_(to.interpolate(topology_, mesh.points).transpose()) {}

  Result<SurfacePath> path() {
    for (const std::int32_t face : start_faces_)
      if (std::ranges::find(end_faces_, face) != end_faces_.end())
        return SurfacePath{{start_, end_}, (end_ - start_).norm()};
    gather_edges();
    if (!search()) return fail("", "goes between parts of the surface that do not hang together");
    pull_straight();
    SurfacePath path{{start_}, 0};
    for (const EdgeCrossing& crossing : crossings_) path.points.push_back(place(crossing));
    path.points.push_back(end_);
    for (std::size_t k = 1; k < path.points.size(); ++k) path.length_mm += (path.points[k] - path.points[k - 1]).norm();
    return path;
  }

 private:
  /// The edge from corner k to corner k + 1 of each face.
  void gather_edges() {
    const Triangles& triangles = topology_.triangles();
    const auto& edges = topology_.edges();
    edges_of_face_.resize(static_cast<std::size_t>(triangles.rows()));
    faces_of_edge_.assign(edges.size(), {-1, -1});
    for (Eigen::Index f = 0; f < triangles.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        std::array<std::int32_t, 2> ends{triangles(f, k), triangles(f, (k + 1) % 3)};
        if (ends[0] > ends[1]) std::swap(ends[0], ends[1]);
        const auto edge = static_cast<std::size_t>(std::ranges::lower_bound(edges, ends) - edges.begin());
        edges_of_face_[f][k] = static_cast<std::int32_t>(edge);
        auto& faces = faces_of_edge_[edge];
        faces[faces[0] < 0 ? 0 : 1] = static_cast<std::int32_t>(f);
      }
  }

  Vec3 vertex(std::int32_t v) const { return mesh_.points.row(v); }
  Vec3 place(const EdgeCrossing& crossing) const {
    const auto& [a, b] = topology_.edges()[crossing.edge];
    return vertex(a) + crossing.share * (vertex(b) - vertex(a));
  }
  static EdgeCrossing crossing_of(std::int32_t node) {
    return {node / places_an_edge, (node % places_an_edge + 1.0) / (places_an_edge + 1)};
  }

  /// Fills in `crossings_`; false where no way leads there.
  bool search() {
    const auto nodes = static_cast<std::int32_t>(topology_.edges().size()) * places_an_edge;
    const std::int32_t last = nodes;  // the end
    std::vector<double> way_mm(static_cast<std::size_t>(nodes) + 1, std::numeric_limits<double>::infinity());
    std::vector<std::int32_t> before(way_mm.size(), -1);
    using Reached = std::pair<double, std::int32_t>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> waiting;
    const auto reach = [&](std::int32_t node, const Vec3& at, double mm, std::int32_t from) {
      double& known = way_mm[node];
      if (mm >= known) return;
      known = mm;
      before[node] = from;
      waiting.emplace(mm + (end_ - at).norm(), node);
    };
    const auto reach_over = [&](std::int32_t face, const Vec3& at, double mm, std::int32_t from) {
      for (const std::int32_t edge : edges_of_face_[face]) {
        if (from >= 0 && from / places_an_edge == edge) continue;
        for (int k = 0; k < places_an_edge; ++k) {
          const std::int32_t node = edge * places_an_edge + k;
          const Vec3 there = place(crossing_of(node));
          reach(node, there, mm + (there - at).norm(), from);
        }
      }
    };
    for (const std::int32_t face : start_faces_) reach_over(face, start_, 0, -1);
    while (!waiting.empty()) {
      const auto [bound, node] = waiting.top();
      waiting.pop();
      if (node == last) break;
      const Vec3 at = place(crossing_of(node));
      const double mm = way_mm[node];
      if (bound > mm + (end_ - at).norm()) continue;  // a shorter way came later
      for (const std::int32_t face : faces_of_edge_[node / places_an_edge]) {
        if (face < 0) continue;
        if (std::ranges::find(end_faces_, face) != end_faces_.end()) reach(last, end_, mm + (end_ - at).norm(), node);
        reach_over(face, at, mm, node);
      }
    }
    if (before[last] < 0) return false;
    for (std::int32_t node = before[last]; node >= 0; node = before[node]) crossings_.push_back(crossing_of(node));
    std::ranges::reverse(crossings_);
    return true;
  }

  /// Moves each crossing along its edge to where the way through it is straight with the two faces laid flat, in turn
  /// until all rest. The length over given edges has one minimum.
  void pull_straight() {
    constexpr int most_rounds = 20'000;
    std::vector<Vec3> at{start_};
    for (const EdgeCrossing& crossing : crossings_) at.push_back(place(crossing));
    at.push_back(end_);
    for (int round = 0; round < most_rounds; ++round) {
      double moved = 0;
      for (std::size_t k = 0; k < crossings_.size(); ++k) {
        EdgeCrossing& crossing = crossings_[k];
        const auto& [a, b] = topology_.edges()[crossing.edge];
        const Vec3 along = vertex(b) - vertex(a);
        const double length2 = along.squaredNorm();
        const Vec3 from = at[k] - vertex(a), to = at[k + 2] - vertex(a);
        const double from_share = from.dot(along) / length2, to_share = to.dot(along) / length2;
        const double from_mm = (from - from_share * along).norm(), to_mm = (to - to_share * along).norm();
        const double both_mm = from_mm + to_mm;
        const double straight =
            both_mm > 0 ? from_share + (to_share - from_share) * from_mm / both_mm : (from_share + to_share) / 2;
        const double share = std::clamp(straight, 0.0, 1.0);
        moved = std::max(moved, std::abs(share - crossing.share));
        crossing.share = share;
        at[k + 1] = place(crossing);
      }
      if (moved < 1e-12) break;
    }
  }

  const Mesh& mesh_;
  const Topology& topology_;
  std::vector<std::int32_t> start_faces_, end_faces_;
  Vec3 start_, end_;
  std::vector<std::array<std::int32_t, 3>> edges_of_face_;
  std::vector<std::array<std::int32_t, 2>> faces_of_edge_;
  std::vector<EdgeCrossing> crossings_;
};

}  // namespace

Result<SurfacePath> shortest_path(const Mesh& mesh, const SurfacePoint& from, const SurfacePoint& to) {
  return PathSearch(mesh, from, to).path();
}

}  // namespace homolog
