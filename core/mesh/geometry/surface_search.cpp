#include "core/mesh/geometry/surface_search.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/numbers/nearest_on_segment.h"
#include "core/base/processes/parallel.h"

namespace homolog {
namespace {

constexpr std::int32_t leaf_faces = 2;
constexpr int stack_depth = 64;  // median splits: depth ≤ log2(faces) + 1, two entries a level

/// Nodes still to visit, nearer ones on top.
template <class Entry>
class Stack {
 public:
  void push(Entry entry) {
    assert(size_ < stack_depth);
    entries_[size_++] = entry;
  }
  Entry pop() { return entries_[--size_]; }
  bool empty() const { return size_ == 0; }

 private:
  std::array<Entry, stack_depth> entries_;
  int size_ = 0;
};

struct Visit {
  std::int32_t node;
  double key;  ///< lower bound of what the node can offer
};

double squared_distance(const Box& box, const Vec3& p) {
  return (box.min() - p).cwiseMax(p - box.max()).cwiseMax(0).squaredNorm();  // unlike Eigen's, without branches
}

Vec3 nearest_on_edges(const Vec3& p, const std::array<Vec3, 3>& corners) {
  Vec3 best = Vec3::Zero();
  double best2 = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = corners[k], &b = corners[(k + 1) % 3];
    const double t = nearest_on_segment(p, a, b);
    const double distance2 = (a + t * (b - a) - p).squaredNorm();
    if (distance2 >= best2) continue;
    best2 = distance2;
    best.setZero();
    best[static_cast<Eigen::Index>(k)] = 1 - t;
    best[static_cast<Eigen::Index>((k + 1) % 3)] = t;
  }
  return best;
}

/// A ray prepared for box tests.
struct Ray {
  Vec3 from, direction, inverse;

  /// Parameter at which the ray enters the box, infinity where it misses it.
  double enters(const Box& box) const {
    double low = 0, high = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0) {
        if (from[k] < box.min()[k] || from[k] > box.max()[k]) return std::numeric_limits<double>::infinity();
        continue;
      }
      const double a = (box.min()[k] - from[k]) * inverse[k], b = (box.max()[k] - from[k]) * inverse[k];
      low = std::max(low, std::min(a, b));
      high = std::min(high, std::max(a, b));
    }
    constexpr double slack = 1 + 4 * std::numeric_limits<double>::epsilon();  // rounding must not open gaps
    return low <= high * slack ? low : std::numeric_limits<double>::infinity();
  }

  /// Barycentric weights of the crossing with the plane of a triangle if it is inside. Neighbouring faces compute the
  /// side of their common edge with the same numbers, so no ray slips through between them.
  std::optional<Vec3> crosses(const Vec3& a, const Vec3& b, const Vec3& c) const {
    const Vec3 pa = a - from, pb = b - from, pc = c - from;
    const Vec3 sides(direction.dot(pb.cross(pc)), direction.dot(pc.cross(pa)), direction.dot(pa.cross(pb)));
    if (!((sides.array() >= 0).all() || (sides.array() <= 0).all()) || sides.sum() == 0) return std::nullopt;
    return sides / sides.sum();
  }
};

}  // namespace

Vec3 nearest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  // By the Voronoi regions of corners, edges and face [Ericson, Real-Time Collision Detection, §5.1.5].
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  const double sum = va + vb + vc;  // |ab × ac|²
  if (va > 0 && vb > 0 && vc > 0 && sum > 1e-14 * ab.squaredNorm() * ac.squaredNorm()) return Vec3(va, vb, vc) / sum;
  return nearest_on_edges(p, {a, b, c});
}

Points closest_places(const Mesh& surface, const Points& points) {
  const SurfaceSearch search(surface);
  Points closest(points.rows(), 3);
  in_parallel(points.rows(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) closest.row(i) = search.nearest(points.row(i)).position;
  });
  return closest;
}

SurfaceSearch::Nearest nearest_on_surface(const Topology& topology, const Points& points, const Vec3& p) {
  const Triangles& triangles = topology.triangles();
  SurfaceSearch::Nearest best;
  double best2 = std::numeric_limits<double>::infinity();
  for (Eigen::Index face = 0; face < triangles.rows(); ++face) {
    const auto corner = [&](int k) { return Vec3(points.row(triangles(face, k))); };
    const Vec3 a = corner(0), b = corner(1), c = corner(2);
    if (squared_distance(Box(a).extend(b).extend(c), p) >= best2) continue;
    const Vec3 weights = nearest_in_triangle(p, a, b, c);
    const Vec3 position = weights[0] * a + weights[1] * b + weights[2] * c;
    const double distance2 = (position - p).squaredNorm();
    if (distance2 >= best2) continue;
    best2 = distance2;
    best = {{static_cast<std::int32_t>(face), weights}, position, std::sqrt(distance2)};
  }
  return best;
}

SurfaceSearch::SurfaceSearch(const Mesh& mesh) : mesh_(mesh) {
  const Triangles& triangles = mesh_.topology->triangles();
  const auto faces = static_cast<std::int32_t>(triangles.rows());
  Points middles(faces, 3);
  for (Eigen::Index f = 0; f < faces; ++f)
    middles.row(f) =
        mesh_.points.row(triangles(f, 0)) + mesh_.points.row(triangles(f, 1)) + mesh_.points.row(triangles(f, 2));

  order_.resize(static_cast<std::size_t>(faces));
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(static_cast<std::size_t>(faces));
  nodes_.push_back({Box(), 0, faces});
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const std::int32_t first = nodes_[n].first, count = nodes_[n].count, half = count / 2;
    if (count <= leaf_faces) continue;
    const auto begin = order_.begin() + first, end = begin + count;
    Box spread;
    for (auto f = begin; f != end; ++f) spread.extend(Vec3(middles.row(*f)));
    Eigen::Index axis = 0;
    spread.sizes().maxCoeff(&axis);
    std::nth_element(begin, begin + half, end, [&](std::int32_t f, std::int32_t g) {
      return middles(f, axis) != middles(g, axis) ? middles(f, axis) < middles(g, axis) : f < g;
    });
    nodes_[n].first = static_cast<std::int32_t>(nodes_.size());
    nodes_[n].count = 0;
    nodes_.push_back({Box(), first, half});
    nodes_.push_back({Box(), first + half, count - half});
  }
  compute_boxes();
}

void SurfaceSearch::compute_boxes() {
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children come after their parents
    Node& node = nodes_[n];
    node.box.setEmpty();
    if (node.count == 0) {
      const auto child = static_cast<std::size_t>(node.first);
      node.box.extend(nodes_[child].box).extend(nodes_[child + 1].box);
    }
    for (std::int32_t i = 0; i < node.count; ++i) node.box.extend(face_box(face_in(node, i)));
  }
}

void SurfaceSearch::refit(const Points& points) {
  assert(points.rows() == mesh_.points.rows());
  mesh_.points = points;
  compute_boxes();
}

std::int32_t SurfaceSearch::face_in(const Node& leaf, std::int32_t i) const {
  return order_[static_cast<std::size_t>(leaf.first) + static_cast<std::size_t>(i)];
}

std::array<Vec3, 3> SurfaceSearch::corners(std::int32_t face) const {
  const auto t = mesh_.topology->triangles().row(face);
  return {Vec3(mesh_.points.row(t[0])), Vec3(mesh_.points.row(t[1])), Vec3(mesh_.points.row(t[2]))};
}

Box SurfaceSearch::face_box(std::int32_t face) const {
  const auto [a, b, c] = corners(face);
  return Box(a).extend(b).extend(c);
}

SurfaceSearch::Nearest SurfaceSearch::at(std::int32_t face, const Vec3& weights, const Vec3& p) const {
  const auto [a, b, c] = corners(face);
  const Vec3 position = weights[0] * a + weights[1] * b + weights[2] * c;
  return {{face, weights}, position, (position - p).norm()};
}

SurfaceSearch::Nearest SurfaceSearch::nearest(const Vec3& p, std::int32_t likely_face) const {
  SurfacePoint best;
  double best2 = std::numeric_limits<double>::infinity();
  const auto try_face = [&](std::int32_t face) {
    const auto [a, b, c] = corners(face);
    const Vec3 weights = nearest_in_triangle(p, a, b, c);
    const double distance2 = (weights[0] * a + weights[1] * b + weights[2] * c - p).squaredNorm();
    if (distance2 >= best2) return;
    best2 = distance2;
    best = {face, weights};
  };
  try_face(likely_face);
  Stack<Visit> stack;
  stack.push({0, 0});
  while (!stack.empty()) {
    const Visit visit = stack.pop();
    if (visit.key >= best2) continue;
    const Node& node = nodes_[visit.node];
    if (node.count == 0) {
      Visit near{node.first, squared_distance(nodes_[node.first].box, p)};
      Visit far{node.first + 1, squared_distance(nodes_[static_cast<std::size_t>(node.first) + 1].box, p)};
      if (far.key < near.key) std::swap(near, far);
      stack.push(far);
      stack.push(near);
    }
    for (std::int32_t i = 0; i < node.count; ++i) try_face(face_in(node, i));
  }
  return at(best.face, best.weights, p);
}

std::optional<SurfaceSearch::Nearest> SurfaceSearch::first_hit(const Vec3& from, const Vec3& direction) const {
  const Ray ray{from, direction, direction.cwiseInverse()};
  const double length2 = direction.squaredNorm();
  std::optional<SurfacePoint> best;
  double best_t = std::numeric_limits<double>::infinity();
  Stack<Visit> stack;
  stack.push({0, ray.enters(nodes_[0].box)});
  while (!stack.empty()) {
    const Visit visit = stack.pop();
    if (visit.key >= best_t) continue;
    const Node& node = nodes_[visit.node];
    if (node.count == 0) {
      Visit near{node.first, ray.enters(nodes_[node.first].box)};
      Visit far{node.first + 1, ray.enters(nodes_[static_cast<std::size_t>(node.first) + 1].box)};
      if (far.key < near.key) std::swap(near, far);
      stack.push(far);
      stack.push(near);
    }
    for (std::int32_t i = 0; i < node.count; ++i) {
      const std::int32_t face = face_in(node, i);
      const auto [a, b, c] = corners(face);
      const auto weights = ray.crosses(a, b, c);
      if (!weights) continue;
      const double t = ((*weights)[0] * a + (*weights)[1] * b + (*weights)[2] * c - from).dot(direction) / length2;
      if (t < 0 || t >= best_t) continue;
      best_t = t;
      best = {face, *weights};
    }
  }
  if (!best) return std::nullopt;
  return at(best->face, best->weights, from);
}

void SurfaceSearch::for_each_near_pair(const std::function<bool(std::int32_t, std::int32_t)>& visit) const {
  std::vector<Box> boxes(order_.size());
  for (std::size_t f = 0; f < boxes.size(); ++f) boxes[f] = face_box(static_cast<std::int32_t>(f));
  const auto visit_meeting = [&](std::int32_t f, std::int32_t g) {
    const Box &a = boxes[f], &b = boxes[g];
    return !a.intersects(b) || visit(std::min(f, g), std::max(f, g));
  };
  // Two nodes whose faces are to be compared; a node with itself at first.
  std::vector<std::array<std::int32_t, 2>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [a, b] = stack.back();
    stack.pop_back();
    const Node &one = nodes_[a], &other = nodes_[b];
    if (a != b && !one.box.intersects(other.box)) continue;
    if (a == b && one.count == 0) {
      stack.push_back({one.first, one.first});
      stack.push_back({one.first + 1, one.first + 1});
      stack.push_back({one.first, one.first + 1});
    } else if (one.count == 0) {
      stack.push_back({one.first, b});
      stack.push_back({one.first + 1, b});
    } else if (other.count == 0) {
      stack.push_back({a, other.first});
      stack.push_back({a, other.first + 1});
    } else {
      for (std::int32_t i = 0; i < one.count; ++i)
        for (std::int32_t k = a == b ? i + 1 : 0; k < other.count; ++k)
          if (!visit_meeting(face_in(one, i), face_in(other, k))) return;
    }
  }
}

}  // namespace homolog
