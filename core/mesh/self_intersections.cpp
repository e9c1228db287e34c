#include <algorithm>

#include "core/mesh/geometry/predicates.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {
namespace {

using Corners = std::array<Vec3, 3>;

// How many neighbours are looked at: a sound mesh has about 25 a face. More have meshes of long needles or of copies of
// one surface, where looking at all would take time with the square of the faces.
constexpr std::size_t least_looks = 4'000'000, looks_per_face = 100;

/// Whether a segment meets a triangle whose plane does not hold the whole segment; touching counts.
bool crosses(const Vec3& p, const Vec3& q, const Corners& t) {
  const int at_p = orientation(t[0], t[1], t[2], p), at_q = orientation(t[0], t[1], t[2], q);
  if (at_p * at_q > 0 || (at_p == 0 && at_q == 0)) return false;
  const int s0 = orientation(p, q, t[0], t[1]), s1 = orientation(p, q, t[1], t[2]), s2 = orientation(p, q, t[2], t[0]);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

Eigen::Vector2d without(const Vec3& p, int axis) {
  return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

/// Whether the line through two corners of one of two convex polygons has them strictly on its two sides.
bool separated(std::span<const Vec3> a, std::span<const Vec3> b, int axis) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d from = without(a[i], axis), to = without(a[(i + 1) % a.size()], axis);
    const auto range = [&](std::span<const Vec3> polygon) {
      std::pair sides{1, -1};
      for (const Vec3& p : polygon) {
        const int side = orientation(from, to, without(p, axis));
        sides = {std::min(sides.first, side), std::max(sides.second, side)};
      }
      return sides;
    };
    const auto [a_low, a_high] = range(a);
    const auto [b_low, b_high] = range(b);
    if ((a_high <= 0 && b_low > 0) || (a_low >= 0 && b_high < 0)) return true;
  }
  return false;
}

/// Whether two convex polygons (or segments) of one plane meet: one of the three projections keeps the plane apart.
bool meet_in_plane(std::span<const Vec3> a, std::span<const Vec3> b) {
  for (int axis = 0; axis < 3; ++axis)
    if (separated(a, b, axis) || separated(b, a, axis)) return false;
  return true;
}

bool coplanar(const Corners& a, const Corners& b) {
  return std::all_of(b.begin(), b.end(), [&](const Vec3& p) { return orientation(a[0], a[1], a[2], p) == 0; }) &&
         std::all_of(a.begin(), a.end(), [&](const Vec3& p) { return orientation(b[0], b[1], b[2], p) == 0; });
}

bool apart(const Corners& a, const Corners& b) {
  int low = 1, high = -1;
  for (const Vec3& p : b) {
    const int side = orientation(a[0], a[1], a[2], p);
    low = std::min(low, side);
    high = std::max(high, side);
  }
  return low > 0 || high < 0;
}

bool meet(const Corners& a, const Corners& b) {
  if (apart(a, b) || apart(b, a)) return false;
  if (coplanar(a, b)) return meet_in_plane(a, b);
  for (std::size_t k = 0; k < 3; ++k)
    if (crosses(a[k], a[(k + 1) % 3], b) || crosses(b[k], b[(k + 1) % 3], a)) return true;
  return false;
}

/// Triangles whose corners 0 are one vertex: what they share beyond it reaches the far edge of one of them.
bool meet_beyond_vertex(const Corners& a, const Corners& b) {
  if (!coplanar(a, b)) return crosses(a[1], a[2], b) || crosses(b[1], b[2], a);
  return meet_in_plane(std::span(a).last(2), b) || meet_in_plane(std::span(b).last(2), a);
}

/// Triangles whose corners 0 and 1 are one edge: one is folded flat onto the other.
bool meet_beyond_edge(const Corners& a, const Corners& b) {
  if (orientation(a[0], a[1], a[2], b[2]) != 0) return false;
  bool same_side = false;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector2d from = without(a[0], axis), to = without(a[1], axis);
    const int sides = orientation(from, to, without(a[2], axis)) * orientation(from, to, without(b[2], axis));
    if (sides < 0) return false;
    same_side = same_side || sides > 0;
  }
  return same_side;
}

class Faces {
 public:
  explicit Faces(const Mesh& mesh) : mesh_(mesh) {}

  bool intersect(std::int32_t f, std::int32_t g) const {
    // The shared vertices first, in the same order in both faces.
    std::array<std::int32_t, 3> a = vertices(f), b = vertices(g);
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto twin = std::find(b.begin() + static_cast<std::ptrdiff_t>(shared), b.end(), a[i]);
      if (twin == b.end()) continue;
      std::swap(*twin, b[shared]);
      std::swap(a[i], a[shared]);
      ++shared;
    }
    const Corners p = corners(a), q = corners(b);
    return shared == 0 ? meet(p, q) : shared == 1 ? meet_beyond_vertex(p, q) : shared == 3 || meet_beyond_edge(p, q);
  }

 private:
  std::array<std::int32_t, 3> vertices(std::int32_t f) const {
    const auto t = mesh_.topology->triangles().row(f);
    return {t[0], t[1], t[2]};
  }
  Corners corners(const std::array<std::int32_t, 3>& v) const {
    return {Vec3(mesh_.points.row(v[0])), Vec3(mesh_.points.row(v[1])), Vec3(mesh_.points.row(v[2]))};
  }

  const Mesh& mesh_;
};

}  // namespace

SelfIntersections find_self_intersections(const Mesh& mesh) {
  const SurfaceSearch search(mesh);
  const Faces faces(mesh);
  const auto count = static_cast<std::size_t>(mesh.topology->triangles().rows());
  // A pair is a look from either of its faces, and each face lies near itself.
  std::size_t looks = least_looks + (looks_per_face - 1) * count;
  SelfIntersections found;
  search.for_each_near_pair([&](std::int32_t f, std::int32_t g) {
    found.all = looks >= 2;
    if (!found.all) return false;
    looks -= 2;
    if (!faces.intersect(f, g)) return true;
    found.all = found.pairs.size() < most_intersections;
    if (found.all) found.pairs.push_back({f, g});
    return found.all;
  });
  std::sort(found.pairs.begin(), found.pairs.end());
  return found;
}

std::vector<std::array<std::int32_t, 2>> self_intersections(const Mesh& mesh) {
  return find_self_intersections(mesh).pairs;
}

}  // namespace homolog
