#include "core/mesh/colours.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "core/base/numbers/index.h"
#include "core/base/numbers/statistics.h"

namespace homolog {
namespace {

/// |number[i] − number[j]| of every edge, in no order.
std::vector<std::int32_t> edge_steps(const Topology& topology, const std::vector<std::int32_t>& number) {
  std::vector<std::int32_t> steps;
  steps.reserve(topology.edges().size());
  for (const auto& [a, b] : topology.edges()) steps.push_back(std::abs(number[a] - number[b]));
  return steps;
}

/// A ring × sector grid steps by 1 around a ring, by the ring's length along the axis, and by one more or less across:
/// three steps make up nearly all of its edges.
bool is_grid(const std::vector<std::int32_t>& steps) {
  std::unordered_map<std::int32_t, std::size_t> counts;
  for (const std::int32_t step : steps) ++counts[step];
  std::vector<std::size_t> sizes;
  sizes.reserve(counts.size());
  for (const auto& [step, count] : counts) sizes.push_back(count);
  std::sort(sizes.rbegin(), sizes.rend());
  const std::size_t commonest =
      std::accumulate(sizes.begin(), sizes.begin() + std::min<std::ptrdiff_t>(3, std::ssize(sizes)), std::size_t{0});
  return counts.contains(1) && 5 * commonest >= 4 * steps.size();
}

std::vector<std::int32_t> indices_of(const Topology& topology) {
  std::vector<std::int32_t> indices(index(topology.vertices()));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

}  // namespace

std::vector<std::int32_t> breadth_first_rank(const Topology& topology, std::int32_t first) {
  assert(first >= 0 && first < topology.vertices());
  std::vector<std::int32_t> rank(index(topology.vertices()), -1), queue;
  queue.reserve(rank.size());
  const auto visit = [&](std::int32_t v) {
    if (rank[v] >= 0) return;
    rank[v] = static_cast<std::int32_t>(queue.size());
    queue.push_back(v);
  };
  std::size_t next = 0;
  const auto search_from = [&](std::int32_t start) {
    for (visit(start); next < queue.size(); ++next)
      for (const std::int32_t w : topology.one_ring(queue[next])) visit(w);
  };
  search_from(first);
  for (std::int32_t v = 0; v < topology.vertices(); ++v) search_from(v);
  return rank;
}

bool indices_are_local(const Topology& topology) {
  const auto steps = edge_steps(topology, indices_of(topology));
  return is_grid(steps) || median_of(steps) <= 2 * median_of(edge_steps(topology, breadth_first_rank(topology)));
}

Mesh renumbered(const Mesh& mesh, Eigen::Index first) {
  const auto rank = breadth_first_rank(*mesh.topology, static_cast<std::int32_t>(first));
  Mesh result;
  result.points.resize(mesh.points.rows(), 3);
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) result.points.row(rank[v]) = mesh.points.row(v);
  Triangles triangles = mesh.topology->triangles().unaryExpr([&](std::int32_t v) { return rank[v]; });
  result.topology = Topology::make(mesh.points.rows(), std::move(triangles)).value();
  return result;
}

std::vector<float> vertex_hues(const Topology& topology) {
  const auto number = indices_are_local(topology) ? indices_of(topology) : breadth_first_rank(topology);
  std::vector<float> hues(number.size());
  for (std::size_t i = 0; i < hues.size(); ++i)
    hues[i] = static_cast<float>(static_cast<double>(number[i]) / static_cast<double>(hues.size()));
  return hues;
}

Rgb hsv_to_rgb(float hue, float saturation, float value) {
  const auto channel = [&](float shift) {
    const float sixth = std::fmod(shift + 6 * hue, 6.0f);
    return value * (1 - saturation * std::clamp(std::min(sixth, 4 - sixth), 0.0f, 1.0f));
  };
  return {channel(5), channel(3), channel(1)};
}

const std::vector<Rgb>& diverging_scale() {
  static const std::vector<Rgb> scale{{0.13f, 0.35f, 0.85f},
                                      {0.55f, 0.72f, 0.95f},
                                      {0.93f, 0.93f, 0.93f},
                                      {0.96f, 0.62f, 0.47f},
                                      {0.82f, 0.16f, 0.16f}};
  return scale;
}

const std::vector<Rgb>& rising_scale() {
  static const std::vector<Rgb> scale{{0.17f, 0.19f, 0.38f},
                                      {0.15f, 0.45f, 0.56f},
                                      {0.29f, 0.69f, 0.49f},
                                      {0.68f, 0.85f, 0.32f},
                                      {1.00f, 0.97f, 0.70f}};
  return scale;
}

const std::vector<Rgb>& confidence_scale() {
  static const std::vector<Rgb> scale{{0.80f, 0.10f, 0.32f}, {0.97f, 0.62f, 0.30f}, {0.60f, 0.98f, 0.88f}};
  return scale;
}

const std::vector<Rgb>& doubt_scale() {
  static const std::vector<Rgb> scale(confidence_scale().rbegin(), confidence_scale().rend());
  return scale;
}

std::vector<std::int32_t> glyph_vertices(const Mesh& mesh, double spacing_mm) {
  std::vector<std::int32_t> order = indices_of(*mesh.topology);
  const VertexScalars curvature = gaussian_curvature(mesh);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return curvature[a] > curvature[b]; });
  if (!(spacing_mm > 0)) return order;

  // Chosen vertices by the cell of a grid of that spacing: only neighbouring cells can hold one that is too near.
  std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, std::vector<std::int32_t>> chosen_in_cell;
  const Vec3 origin = bounds_of(mesh.points).min();
  const auto cell_of = [&](std::int32_t v) {
    const Vec3 cell = ((Vec3(mesh.points.row(v)) - origin) / spacing_mm).array().floor();
    return std::array{static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
                      static_cast<std::int64_t>(cell.z())};
  };
  const auto is_taken = [&](std::int32_t v, const std::array<std::int64_t, 3>& cell) {
    for (std::int64_t n = 0; n < 27; ++n) {
      const auto near = chosen_in_cell.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (near == chosen_in_cell.end()) continue;
      for (const std::int32_t w : near->second)
        if ((mesh.points.row(v) - mesh.points.row(w)).norm() <= spacing_mm) return true;
    }
    return false;
  };
  std::vector<std::int32_t> chosen;
  for (const std::int32_t v : order) {
    const auto cell = cell_of(v);
    if (is_taken(v, cell)) continue;
    chosen.push_back(v);
    chosen_in_cell[{cell[0], cell[1], cell[2]}].push_back(v);
  }
  return chosen;
}

}  // namespace homolog
