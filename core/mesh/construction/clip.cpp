#include "core/mesh/construction/clip.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace homolog {

std::optional<Mesh> clipped(const Mesh& mesh, const VertexScalars& values) {
  std::vector<Vec3> points;
  std::vector<std::int32_t> kept(static_cast<std::size_t>(mesh.points.rows()), -1);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> cut_edges;
  const auto keep = [&](std::int32_t i) {
    std::int32_t& there = kept[i];
    if (there < 0) {
      there = static_cast<std::int32_t>(points.size());
      points.emplace_back(mesh.points.row(i));
    }
    return there;
  };
  const auto crossing = [&](std::int32_t a, std::int32_t b) {
    if (a > b) std::swap(a, b);
    const auto [there, is_new] = cut_edges.try_emplace({a, b}, static_cast<std::int32_t>(points.size()));
    if (is_new) {
      const double share = values[a] / (values[a] - values[b]);
      points.emplace_back(mesh.points.row(a) + share * (mesh.points.row(b) - mesh.points.row(a)));
    }
    return there->second;
  };
  std::vector<std::array<std::int32_t, 3>> faces;
  const Triangles& triangles = mesh.topology->triangles();
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    std::array<std::int32_t, 4> corners{};
    std::size_t count = 0;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const std::int32_t a = triangles(f, k), b = triangles(f, (k + 1) % 3);
      if (values[a] < 0) corners[count++] = keep(a);
      if ((values[a] < 0) != (values[b] < 0)) corners[count++] = crossing(a, b);
    }
    for (std::size_t k = 2; k < count; ++k) faces.push_back({corners[0], corners[k - 1], corners[k]});
  }
  if (faces.empty()) return std::nullopt;
  Mesh left;
  left.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) left.points.row(static_cast<Eigen::Index>(i)) = points[i];
  Triangles of(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) of(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = faces[f][k];
  auto topology = Topology::make(left.points.rows(), of);
  if (!topology) return std::nullopt;
  left.topology = std::move(*topology);
  return left;
}

std::optional<Mesh> clipped(const Mesh& mesh, const Vec3& outward, double offset_mm) {
  return clipped(mesh, VertexScalars(mesh.points * outward - VertexScalars::Constant(mesh.points.rows(), offset_mm)));
}

}  // namespace homolog
