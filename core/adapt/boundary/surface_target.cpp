#include "core/adapt/boundary/surface_target.h"

#include <algorithm>
#include <utility>

#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double same_way = 0.4;      ///< cosine between normals of places that may be counterparts
constexpr double widest_reach = 0.1;  ///< share of an organ that may lack parts: so far it looks for counterparts first

}  // namespace

SurfaceTarget::SurfaceTarget(const Boundary& boundary, Eigen::Index vertices, bool lacks_parts)
    : boundary_(boundary),
      search_(boundary.surface),
      normals_(vertex_normals(boundary.surface)),
      size_mm_(std::sqrt(surface_area_mm2(boundary.surface))),
      rims_(lacks_parts ? std::vector<Rim>() : long_rims(boundary.surface)) {
  const Mesh& surface = boundary.surface;
  const Eigen::Index count = surface.points.rows();
  const VertexScalars area = vertex_areas_mm2(surface);
  area_mm2_ = area.sum();
  const Eigen::Index stride = 1 + count / vertices;
  for (Eigen::Index v = 0; v < count; v += stride) {
    const Vec3 position = surface.points.row(v);
    if (boundary.shows(position) && boundary.is_own(surface.topology->faces_of(v).front()))
      samples_.push_back({position, normals_.row(v), static_cast<double>(stride) * area[v], {}});
  }
  likely_faces_.assign(static_cast<std::size_t>(vertices), 0);
}

Vec3 SurfaceTarget::normal_at(const SurfacePoint& at) const {
  return at.interpolate(*boundary_.surface.topology, normals_).transpose();
}

std::optional<SurfaceTarget::Counterpart> SurfaceTarget::counterpart(const Vec3& p, const Vec3& normal,
                                                                     std::int32_t& likely_face) const {
  if (!boundary_.shows(p)) return std::nullopt;
  const auto nearest = search_.nearest(p, likely_face);
  likely_face = nearest.at.face;
  auto found = std::optional(nearest);
  if (normal_at(nearest.at).dot(normal) < same_way) {
    // Another sheet is nearer: the right one lies along the normal, if anywhere.
    found.reset();
    for (const Vec3& direction : {normal, Vec3(-normal)}) {
      const auto hit = search_.first_hit(p, direction);
      if (!hit || normal_at(hit->at).dot(normal) < same_way) continue;
      const double away = (hit->position - p).norm();
      if (!found || away < (found->position - p).norm()) found = hit;
    }
  }
  if (!found || !boundary_.shows(found->position)) return std::nullopt;
  if (rims_count() && on_rim(*boundary_.surface.topology, found->at)) return std::nullopt;
  if (partial() && ((found->position - p).norm() > reach_mm_ || !boundary_.is_own(found->at.face) ||
                    on_rim(*boundary_.surface.topology, found->at)))
    return std::nullopt;
  return Counterpart{found->position, normal_at(found->at).stableNormalized()};
}

void SurfaceTarget::know_rims(const Mesh& mesh) {
  if (std::exchange(knows_rims_, true) || rims_.empty()) return;
  mesh_rims_ = long_rims(mesh);
  on_mesh_rim_.assign(static_cast<std::size_t>(mesh.points.rows()), 0);
  for (const Rim& rim : mesh_rims_) {
    rim_rest_mm_.push_back(rim_edges_mm(rim, mesh.points));
    for (const std::int32_t i : rim) on_mesh_rim_[i] = 1;
  }
}

void SurfaceTarget::nearest_on_rim(const Mesh& mesh, TargetPull& pull) const {
  const Points& there = boundary_.surface.points;
  const Points normals = vertex_normals(mesh);
  for (std::size_t r = 0; r < mesh_rims_.size(); ++r) {
    const Rim& rim = mesh_rims_[r];
    const auto away_mm = [&](const Rim& other) {
      return mean_of(rim, [&](std::int32_t i) {
        const Vec3 p = mesh.points.row(i);
        return (nearest_on_rims({other}, there, p).position - p).norm();
      });
    };
    const Rim& onto = *std::ranges::min_element(rims_, {}, away_mm);
    const std::vector<Vec3> places = spread_on_rim(rim, mesh.points, rim_rest_mm_[r], onto, there);
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const Vec3 p = mesh.points.row(rim[k]);
      if (!boundary_.shows(p) || !boundary_.shows(places[k]) || (places[k] - p).norm() > reach_mm_) continue;
      pull.targets.row(rim[k]) = places[k].transpose();
      pull.normals.row(rim[k]) = normals.row(rim[k]);
      pull.weights[rim[k]] = 1;
    }
  }
}

void SurfaceTarget::pull_rims(const Mesh& mesh, Points& sum, VertexScalars& weights) const {
  double length_mm = 0;
  Eigen::Index count = 0;
  for (const Rim& rim : rims_) length_mm += rim_length_mm(rim, boundary_.surface.points);
  for (const Rim& rim : mesh_rims_) count += std::ssize(rim);
  const double length_a_vertex = length_mm / static_cast<double>(count);
  const Points& there = boundary_.surface.points;
  for (const Rim& rim : rims_)
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const Vec3 before = there.row(rim[(k + rim.size() - 1) % rim.size()]), p = there.row(rim[k]),
                 after = there.row(rim[(k + 1) % rim.size()]);
      if (!boundary_.shows(p)) continue;
      const RimPlace own = nearest_on_rims(mesh_rims_, mesh.points, p);
      if (partial() && (own.position - p).norm() > reach_mm_) continue;
      const double counts = ((p - before).norm() + (after - p).norm()) / 2 / length_a_vertex;
      for (std::size_t end = 0; end < 2; ++end) {
        const double weight = (end == 0 ? 1 - own.share : own.share) * counts;
        sum.row(own.between[end]) += weight * (p - own.position).transpose();
        weights[own.between[end]] += weight;
      }
    }
}

TargetPull SurfaceTarget::nearest(const Mesh& mesh) {
  know_rims(mesh);
  TargetPull pull{mesh.points, VertexScalars::Zero(mesh.points.rows()), Points::Zero(mesh.points.rows(), 3)};
  const Points normals = vertex_normals(mesh);
  in_parallel(mesh.points.rows(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      if (on_mesh_rim(i)) continue;
      const auto there = counterpart(mesh.points.row(i), normals.row(i), likely_faces_[i]);
      if (!there) continue;
      pull.targets.row(i) = there->position.transpose();
      pull.normals.row(i) = there->normal.transpose();
      pull.weights[i] = 1;
    }
  });
  if (rims_count()) nearest_on_rim(mesh, pull);
  return pull;
}

std::vector<std::int32_t> SurfaceTarget::missing(const Mesh& mesh) {
  constexpr int rounds = 5;
  constexpr double fewest = 0.005;  // share of the vertices
  VertexScalars found = nearest(mesh).weights;
  for (int round = 0; round < rounds; ++round) {
    const VertexScalars before = found;
    for (Eigen::Index i = 0; i < found.size(); ++i) {
      double sum = before[i], count = 1;
      for (const std::int32_t j : mesh.topology->one_ring(i)) sum += before[j], ++count;
      found[i] = 2 * sum > count ? 1 : 0;
    }
  }
  std::vector<std::int32_t> missing;
  for (Eigen::Index i = 0; i < found.size(); ++i)
    if (found[i] == 0) missing.push_back(static_cast<std::int32_t>(i));
  if (static_cast<double>(missing.size()) < fewest * static_cast<double>(found.size())) missing.clear();
  return missing;
}

TargetPull SurfaceTarget::pull(const Mesh& mesh, double share) {
  if (std::isfinite(organ_mm_)) reach_mm_ = widest_reach * std::pow(closest_reach / widest_reach, share) * organ_mm_;
  TargetPull pull = nearest(mesh);
  const Points normals = vertex_normals(mesh);
  if (mesh_)
    mesh_->refit(mesh.points);
  else
    mesh_.emplace(mesh);
  in_parallel(samples_.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k)
      samples_[k].on_mesh = mesh_->nearest(samples_[k].position, samples_[k].on_mesh.at.face);
  });
  Points sum = pull.weights.asDiagonal() * (pull.targets - mesh.points);
  const double area_a_vertex = area_mm2_ / static_cast<double>(mesh.points.rows());
  for (const Sample& sample : samples_) {
    const auto& own = sample.on_mesh;
    if (rims_count() && on_rim(*mesh.topology, own.at)) continue;
    // The normals go on over edges: a sample that lies nearest to a corner is as near to several faces, and which
    // of them is named hangs on rounding.
    const Vec3 facing = own.at.interpolate(*mesh.topology, normals).transpose().stableNormalized();
    if (facing.dot(sample.normal) < same_way || (partial() && (own.position - sample.position).norm() > reach_mm_))
      continue;
    const auto corners = mesh.topology->triangles().row(own.at.face);
    for (int c = 0; c < 3; ++c) {
      const double weight = own.at.weights[c] * sample.area_mm2 / area_a_vertex;
      sum.row(corners[c]) += weight * (sample.position - own.position).transpose();
      pull.weights[corners[c]] += weight;
    }
  }
  if (rims_count()) pull_rims(mesh, sum, pull.weights);
  for (Eigen::Index i = 0; i < sum.rows(); ++i)
    if (pull.weights[i] > 0) pull.targets.row(i) = mesh.points.row(i) + sum.row(i) / pull.weights[i];
  pull.weights = pull.weights.cwiseMin(1);
  // A rim has few vertices. While the mesh moves as a whole it tells more than as many others.
  constexpr double rim_counts_at_first = 10;
  for (const Rim& rim : mesh_rims_)
    for (const std::int32_t i : rim) pull.weights[i] *= share + rim_counts_at_first * (1 - share);
  return pull;
}

}  // namespace homolog
