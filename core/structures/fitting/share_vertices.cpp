#include "core/structures/fitting/share_vertices.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "core/base/numbers/index.h"
#include "core/structures/fitting/keep_apart.h"

namespace homolog {

namespace {

/// Of each of `points` the nearest of `others` within some mm; −1: none.
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
      std::int32_t& known = nearest[index(v)];
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

}  // namespace

std::vector<VertexPair> coinciding_vertices(const Points& a, const Points& b, double within_mm) {
  const auto of_a = nearest_vertices(a, b, within_mm), of_b = nearest_vertices(b, a, within_mm);
  std::vector<VertexPair> pairs;
  for (std::size_t v = 0; v < of_a.size(); ++v)
    if (of_a[v] >= 0 && of_b[index(of_a[v])] == static_cast<std::int32_t>(v))
      pairs.push_back({static_cast<std::int32_t>(v), of_a[v]});
  return pairs;
}

void join_shared(const std::vector<SharedVertices>& shared, std::span<const std::string> names,
                 std::vector<Mesh>& meshes) {
  Groups groups(meshes);
  std::vector<std::vector<char>> is_shared(meshes.size());
  for (std::size_t k = 0; k < meshes.size(); ++k) is_shared[k].resize(index(meshes[k].points.rows()));
  bool any = false;
  for (const SharedVertices& one : shared) {
    const auto a = std::ranges::find(names, one.a), b = std::ranges::find(names, one.b);
    if (a == names.end() || b == names.end()) continue;
    const auto at_a = static_cast<std::size_t>(a - names.begin()), at_b = static_cast<std::size_t>(b - names.begin());
    for (const auto& [of_a, of_b] : one.vertices) {
      groups.unite(groups.of(at_a, of_a), groups.of(at_b, of_b));
      is_shared[at_a][index(of_a)] = is_shared[at_b][index(of_b)] = 1;
      any = true;
    }
  }
  if (!any) return;
  std::map<std::size_t, std::pair<Vec3, int>> sums;
  const auto each_shared = [&](const auto& work) {
    for (std::size_t k = 0; k < meshes.size(); ++k)
      for (std::size_t v = 0; v < is_shared[k].size(); ++v)
        if (is_shared[k][v] != 0) work(k, static_cast<std::int32_t>(v));
  };
  each_shared([&](std::size_t k, std::int32_t v) {
    auto& [sum, count] = sums.try_emplace(groups.of(k, v), Vec3::Zero(), 0).first->second;
    sum += meshes[k].points.row(v).transpose();
    ++count;
  });
  std::vector<Points> moves;
  std::vector<VertexScalars> held;
  for (const Mesh& mesh : meshes) {
    moves.emplace_back(Points::Zero(mesh.points.rows(), 3));
    held.emplace_back(VertexScalars::Zero(mesh.points.rows()));
  }
  const auto place = [&](std::size_t k, std::int32_t v) {
    const auto& [sum, count] = sums.at(groups.of(k, v));
    return Vec3(sum / count);
  };
  each_shared([&](std::size_t k, std::int32_t v) {
    moves[k].row(v) = place(k, v).transpose() - meshes[k].points.row(v);
    held[k][v] = 1;
  });
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    if (held[k].isZero()) continue;
    spread_movement(*meshes[k].topology, held[k], moves[k]);
    meshes[k].points += moves[k];
  }
  each_shared([&](std::size_t k, std::int32_t v) { meshes[k].points.row(v) = place(k, v); });  // to the bit
}

}  // namespace homolog
