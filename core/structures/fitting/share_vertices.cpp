#include "core/structures/fitting/share_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "core/base/numbers/index.h"
#include "core/case/moved_points.h"
#include "core/mesh/mesh_quality.h"
#include "core/structures/fitting/keep_apart.h"

namespace homolog {

namespace {

/// The nearest of `others` within some mm of each of `points`; −1: none.
std::vector<std::int32_t> nearest_vertices(const Points& points, const Points& others, double within_mm) {
  std::vector<std::int32_t> by_x(index(others.rows()));
  std::iota(by_x.begin(), by_x.end(), 0);
  std::ranges::stable_sort(by_x, {}, [&](std::int32_t v) { return others(v, 0); });
  std::vector<std::int32_t> nearest(index(points.rows()), -1);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    double best_mm = within_mm;
    auto it =
        std::ranges::lower_bound(by_x, points(v, 0) - within_mm, {}, [&](std::int32_t o) { return others(o, 0); });
    for (; it != by_x.end() && others(*it, 0) <= points(v, 0) + within_mm; ++it) {
      const double mm = (others.row(*it) - points.row(v)).norm();
      std::int32_t& known = nearest[v];
      if (mm > best_mm || (mm == best_mm && known >= 0 && known < *it)) continue;
      best_mm = mm;
      known = *it;
    }
  }
  return nearest;
}

/// Vertices of meshes, and which of them are one.
class Groups {
 public:
  explicit Groups(const std::vector<Mesh>& meshes) {
    std::size_t count = 0;
    for (const Mesh& mesh : meshes) {
      first_.push_back(count);
      count += index(mesh.points.rows());
    }
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t mesh, std::int32_t vertex) {
    std::size_t at = first_[mesh] + index(vertex);
    while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
    return at;
  }
  void unite(std::size_t a, std::size_t b) { parent_[std::max(a, b)] = std::min(a, b); }

 private:
  std::vector<std::size_t> first_, parent_;
};

/// The vertices that meshes share: the groups of vertices that are one.
class SharedGroups {
 public:
  SharedGroups(const std::vector<SharedVertices>& shared, std::span<const std::string> names,
               const std::vector<Mesh>& meshes)
      : groups_(meshes), is_shared_(meshes.size()) {
    for (std::size_t k = 0; k < meshes.size(); ++k) is_shared_[k].resize(index(meshes[k].points.rows()));
    for (const SharedVertices& one : shared) {
      const auto a = std::ranges::find(names, one.a), b = std::ranges::find(names, one.b);
      if (a == names.end() || b == names.end()) continue;
      const auto at_a = static_cast<std::size_t>(a - names.begin()), at_b = static_cast<std::size_t>(b - names.begin());
      for (const auto& [of_a, of_b] : one.vertices) {
        groups_.unite(groups_.of(at_a, of_a), groups_.of(at_b, of_b));
        is_shared_[at_a][of_a] = is_shared_[at_b][of_b] = 1;
        any_ = true;
      }
    }
  }

  bool any() const { return any_; }
  std::size_t of(std::size_t mesh, std::int32_t vertex) { return groups_.of(mesh, vertex); }
  /// Calls `work(mesh, vertex)` for each shared vertex of a mesh.
  void each_of(std::size_t mesh, const auto& work) const {
    for (std::size_t v = 0; v < is_shared_[mesh].size(); ++v)
      if (is_shared_[mesh][v] != 0) work(mesh, static_cast<std::int32_t>(v));
  }
  /// The same for all meshes.
  void each(const auto& work) const {
    for (std::size_t k = 0; k < is_shared_.size(); ++k) each_of(k, work);
  }

 private:
  Groups groups_;
  std::vector<std::vector<char>> is_shared_;
  bool any_ = false;
};

/// Moves each shared vertex to `place(mesh, vertex)`, and those around along. `rings_for(mesh, move)`: how far, in
/// edges.
void bring_shared(const SharedGroups& groups, std::vector<Mesh>& meshes, const auto& place, const auto& rings_for) {
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    Mesh& mesh = meshes[k];
    std::vector<std::pair<std::int32_t, Vec3>> places;
    Points move = Points::Zero(mesh.points.rows(), 3);
    VertexScalars held = VertexScalars::Zero(mesh.points.rows());
    groups.each_of(k, [&](std::size_t, std::int32_t v) {
      places.emplace_back(v, place(k, v));
      move.row(v) = places.back().second.transpose() - mesh.points.row(v);
      held[v] = 1;
    });
    if (move.isZero(0)) continue;
    spread_movement(*mesh.topology, held, move, rings_for(mesh, move));
    mesh.points += move;
    for (const auto& [v, at] : places) mesh.points.row(v) = at;  // to the bit
  }
}

}  // namespace

std::vector<VertexPair> coinciding_vertices(const Points& a, const Points& b, double within_mm) {
  const auto of_a = nearest_vertices(a, b, within_mm), of_b = nearest_vertices(b, a, within_mm);
  std::vector<VertexPair> pairs;
  for (std::size_t v = 0; v < of_a.size(); ++v)
    if (of_a[v] >= 0 && of_b[of_a[v]] == static_cast<std::int32_t>(v))
      pairs.push_back({static_cast<std::int32_t>(v), of_a[v]});
  return pairs;
}

void join_shared(const std::vector<SharedVertices>& shared, std::span<const std::string> names,
                 std::vector<Mesh>& meshes) {
  constexpr int rings = 4;
  SharedGroups groups(shared, names, meshes);
  if (!groups.any()) return;
  std::map<std::size_t, std::pair<Vec3, int>> sums;
  groups.each([&](std::size_t k, std::int32_t v) {
    auto& [sum, count] = sums.try_emplace(groups.of(k, v), Vec3::Zero(), 0).first->second;
    sum += meshes[k].points.row(v).transpose();
    ++count;
  });
  const auto place = [&](std::size_t k, std::int32_t v) {
    const auto& [sum, count] = sums.at(groups.of(k, v));
    return Vec3(sum / count);
  };
  bring_shared(groups, meshes, place, [](const Mesh&, const Points&) { return rings; });
}

void follow_shared(const std::vector<SharedVertices>& shared, std::span<const std::string> names,
                   std::vector<Mesh>& meshes, std::span<const std::size_t> leaders) {
  constexpr double rings_of_edge = 3, rounding_mm = 1e-4;
  constexpr int least_rings = 4, most_rings = 40;
  SharedGroups groups(shared, names, meshes);
  std::map<std::size_t, Vec3> led;  // the place where a leader has the vertices of a group
  for (const std::size_t leader : leaders)
    groups.each_of(leader,
                   [&](std::size_t k, std::int32_t v) { led.try_emplace(groups.of(k, v), meshes[k].points.row(v)); });
  std::set<std::size_t> apart;
  groups.each([&](std::size_t k, std::int32_t v) {
    const auto there = led.find(groups.of(k, v));
    if (there != led.end() && (meshes[k].points.row(v).transpose() - there->second).norm() > shared_place_mm)
      apart.insert(there->first);
  });
  if (apart.empty()) return;
  const auto place = [&](std::size_t k, std::int32_t v) {
    const std::size_t group = groups.of(k, v);
    return apart.contains(group) ? Vec3(led.at(group).unaryExpr([](double mm) { return on_grid(mm); }))
                                 : Vec3(meshes[k].points.row(v));
  };
  bring_shared(groups, meshes, place, [&](const Mesh& mesh, const Points& move) {
    const double farthest_mm = move.rowwise().norm().maxCoeff();
    if (farthest_mm < rounding_mm) return 0;  // those of a leader
    const double edges = farthest_mm / mean_edge_mm(*mesh.topology, mesh.points);
    return std::clamp(static_cast<int>(std::ceil(rings_of_edge * edges)), least_rings, most_rings);
  });
}

}  // namespace homolog
