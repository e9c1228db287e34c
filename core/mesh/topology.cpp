#include "core/mesh/topology.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>

#include "core/base/encoding/hash.h"
#include "core/base/numbers/index.h"

namespace homolog {
namespace {

/// An edge of one face, in the direction of the face.
struct HalfEdge {
  std::int32_t low, high;
  std::int32_t face;
  std::int8_t corner;  ///< it runs from this corner of the face to the next
  bool ascending;      ///< from `low` to `high`
};

Result<void> check_faces(Eigen::Index vertices, const Triangles& triangles) {
  constexpr Eigen::Index limit = std::numeric_limits<std::int32_t>::max() / 8;
  if (triangles.rows() == 0) return fail("", "holds no faces; a surface of triangles is needed");
  if (vertices > limit || triangles.rows() > limit) return fail("", "has too many vertices; decimate the mesh");
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const auto t = triangles.row(f);
    for (int k = 0; k < 3; ++k) {
      if (t[k] < 0 || t[k] >= vertices)
        return fail("", "face " + std::to_string(f) + " names vertex " + std::to_string(t[k]) + " of " +
                            std::to_string(vertices) + " (counted from 0); export the mesh again");
      if (t[k] == t[(k + 1) % 3])
        return fail("", "face " + std::to_string(f) + " names vertex " + std::to_string(t[k]) +
                            " twice; remove degenerate faces from the mesh");
    }
  }
  return {};
}

/// All half-edges, ordered by (low, high), then by face.
std::vector<HalfEdge> sorted_half_edges(Eigen::Index vertices, const Triangles& triangles) {
  std::vector<std::size_t> start(static_cast<std::size_t>(vertices) + 1, 0);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    for (int k = 0; k < 3; ++k) ++start[index(std::min(triangles(f, k), triangles(f, (k + 1) % 3))) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());

  std::vector<HalfEdge> half_edges(start.back());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = triangles(f, k), to = triangles(f, (k + 1) % 3);
      half_edges[next[std::min(from, to)]++] = {std::min(from, to), std::max(from, to), static_cast<std::int32_t>(f),
                                                static_cast<std::int8_t>(k), from < to};
    }
  }
  for (std::size_t v = 0; v + 1 < start.size(); ++v)
    std::sort(half_edges.begin() + static_cast<std::ptrdiff_t>(start[v]),
              half_edges.begin() + static_cast<std::ptrdiff_t>(start[v + 1]), [](const HalfEdge& a, const HalfEdge& b) {
                return std::pair(a.high, a.face) < std::pair(b.high, b.face);
              });
  return half_edges;
}

std::string edge_name(const HalfEdge& edge) {
  return "edge " + std::to_string(edge.low) + "-" + std::to_string(edge.high);
}

std::string hash_of(Eigen::Index vertices, const Triangles& triangles) {
  Hash hash;
  const auto add = [&hash](std::int64_t word) {
    hash.add(static_cast<std::uint32_t>(word));
    hash.value ^= hash.value >> 32;  // a whole word was taken in one step: its high bits go back to the low ones
  };
  add(vertices);
  for (const std::int32_t v : triangles.reshaped<Eigen::RowMajor>()) add(v);
  return hash.hex();
}

}  // namespace

Result<std::shared_ptr<const Topology>> Topology::make(Eigen::Index vertices, Triangles triangles) {
  if (auto checked = check_faces(vertices, triangles); !checked) return fail(checked.error());
  Topology topology;
  topology.vertices_ = vertices;
  topology.triangles_ = std::move(triangles);
  topology.gather_faces();
  if (auto joined = topology.join_faces(); !joined) return fail(joined.error());
  if (auto checked = topology.check_fans(); !checked) return fail(checked.error());
  topology.gather_rings();
  topology.trace_boundary();
  topology.number_components();
  topology.hash_ = hash_of(vertices, topology.triangles_);
  return std::make_shared<const Topology>(std::move(topology));
}

void Topology::gather_faces() {
  face_start_.assign(static_cast<std::size_t>(vertices_) + 1, 0);
  for (const std::int32_t v : triangles_.reshaped()) ++face_start_[index(v) + 1];
  std::partial_sum(face_start_.begin(), face_start_.end(), face_start_.begin());
  faces_.resize(face_start_.back());
  std::vector<std::size_t> next(face_start_.begin(), face_start_.end() - 1);
  for (Eigen::Index f = 0; f < triangles_.rows(); ++f)
    for (int k = 0; k < 3; ++k) faces_[next[triangles_(f, k)]++] = static_cast<std::int32_t>(f);
}

Result<void> Topology::join_faces() {
  const std::vector<HalfEdge> half_edges = sorted_half_edges(vertices_, triangles_);
  neighbours_.assign(static_cast<std::size_t>(triangles_.rows()), {-1, -1, -1});
  edges_.reserve(half_edges.size() / 2);
  for (std::size_t i = 0; i < half_edges.size();) {
    const HalfEdge& a = half_edges[i];
    std::size_t end = i + 1;
    while (end < half_edges.size() && half_edges[end].low == a.low && half_edges[end].high == a.high) ++end;
    if (end - i > 2)
      return fail("", edge_name(a) + " has " + std::to_string(end - i) +
                          " faces; remove duplicate faces and non-manifold edges from the mesh");
    if (end - i == 2) {
      const HalfEdge& b = half_edges[i + 1];
      if (a.ascending == b.ascending)
        return fail("", "faces " + std::to_string(a.face) + " and " + std::to_string(b.face) + " at " + edge_name(a) +
                            " are oriented against each other; orient the faces of the mesh coherently");
      neighbours_[a.face][a.corner] = b.face;
      neighbours_[b.face][b.corner] = a.face;
    }
    edges_.push_back({a.low, a.high});
    i = end;
  }
  return {};
}

std::size_t Topology::fan_size(std::int32_t vertex) const {
  const auto corner_of = [&](std::int32_t face) {
    return static_cast<std::size_t>(triangles_(face, 1) == vertex ? 1 : triangles_(face, 2) == vertex ? 2 : 0);
  };
  const std::int32_t start = faces_[face_start_[vertex]];
  std::size_t size = 1;
  for (const std::size_t side : {std::size_t{2}, std::size_t{0}}) {  // round to the left, then to the right
    std::int32_t face = start;
    while ((face = neighbours_[face][(corner_of(face) + side) % 3]) >= 0) {
      if (face == start) return size;
      ++size;
    }
  }
  return size;
}

Result<void> Topology::check_fans() const {
  for (std::int32_t v = 0; v < vertices_; ++v) {
    const std::size_t faces = faces_of(v).size();
    if (faces == 0)
      return fail("",
                  "vertex " + std::to_string(v) + " belongs to no face; remove unreferenced vertices from the mesh");
    if (fan_size(v) != faces)
      return fail("", "vertex " + std::to_string(v) +
                          " joins two parts that share no edge at it; split non-manifold vertices of the mesh");
  }
  return {};
}

void Topology::gather_rings() {
  ring_start_.assign(static_cast<std::size_t>(vertices_) + 1, 0);
  for (const auto& [low, high] : edges_) {
    ++ring_start_[index(low) + 1];
    ++ring_start_[index(high) + 1];
  }
  std::partial_sum(ring_start_.begin(), ring_start_.end(), ring_start_.begin());
  ring_.resize(ring_start_.back());
  std::vector<std::size_t> next(ring_start_.begin(), ring_start_.end() - 1);
  // The edges are sorted: taking the lower neighbours of every vertex first leaves each ring ascending.
  for (const auto& [low, high] : edges_) ring_[next[high]++] = low;
  for (const auto& [low, high] : edges_) ring_[next[low]++] = high;
}

void Topology::trace_boundary() {
  on_rim_.assign(static_cast<std::size_t>(vertices_), 0);
  std::vector<std::int32_t> after(static_cast<std::size_t>(vertices_), -1);  // one fan a vertex: one way on
  for (Eigen::Index f = 0; f < triangles_.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (neighbours(f)[k] >= 0) continue;
      after[triangles_(f, k)] = triangles_(f, (k + 1) % 3);
      on_rim_[triangles_(f, k)] = 1;
    }
  }
  for (std::int32_t v = 0; v < vertices_; ++v) {
    if (after[v] < 0) continue;
    std::vector<std::int32_t> loop;
    for (std::int32_t w = v; after[w] >= 0; w = std::exchange(after[w], -1)) loop.push_back(w);
    rims_.push_back(std::move(loop));
  }
}

void Topology::number_components() {
  component_.assign(static_cast<std::size_t>(vertices_), -1);
  std::vector<std::int32_t> queue;
  for (std::int32_t first = 0; first < vertices_; ++first) {
    if (component_[first] >= 0) continue;
    component_[first] = components_;
    queue.assign(1, first);
    while (!queue.empty()) {
      const std::int32_t v = queue.back();
      queue.pop_back();
      for (const std::int32_t w : one_ring(v)) {
        if (component_[w] >= 0) continue;
        component_[w] = components_;
        queue.push_back(w);
      }
    }
    ++components_;
  }
}

int Topology::genus() const {
  const auto euler = vertices_ - static_cast<Eigen::Index>(edges_.size()) + triangles_.rows() +
                     static_cast<Eigen::Index>(rims_.size());
  return static_cast<int>((2 * components_ - euler) / 2);
}

}  // namespace homolog
