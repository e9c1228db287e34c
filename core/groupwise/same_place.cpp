#include "core/groupwise/same_place.h"

#include <algorithm>

#include "core/base/processes/parallel.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/parts/patches.h"

namespace homolog {

namespace {

constexpr double off_share = 0.015;  ///< share of the diagonal
constexpr std::size_t fewest_fits = 3;
constexpr double fewest_vertices = 0.004;  ///< share of all

}  // namespace

VertexScalars off_target_mm(const Mesh& fitted, const Boundary& target) {
  VertexScalars off_mm = VertexScalars::Zero(fitted.points.rows());
  const SurfaceSearch on_target(target.surface), on_mesh(fitted);
  in_parallel(off_mm.size(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i)
      if (target.shows(fitted.points.row(i))) off_mm[i] = on_target.nearest(fitted.points.row(i)).distance_mm;
  });
  const Points& places = target.surface.points;
  for (Eigen::Index k = 0; k < places.rows(); k += 1 + places.rows() / (4 * off_mm.size())) {
    if (!target.shows(places.row(k))) continue;
    const auto nearest = on_mesh.nearest(places.row(k));
    Eigen::Index corner = 0;
    nearest.at.weights.maxCoeff(&corner);
    double& there_mm = off_mm[fitted.topology->triangles()(nearest.at.face, corner)];
    there_mm = std::max(there_mm, nearest.distance_mm);
  }
  return off_mm;
}

std::optional<SamePlace> off_at_same_place(const Topology& topology, const std::vector<VertexScalars>& off_shares) {
  if (off_shares.size() < fewest_fits) return std::nullopt;
  const auto count = static_cast<std::size_t>(topology.vertices());
  std::vector<std::size_t> off(count, 0);
  for (const VertexScalars& one : off_shares)
    for (std::size_t i = 0; i < count; ++i) off[i] += one[static_cast<Eigen::Index>(i)] > off_share ? 1 : 0;
  const std::size_t enough = std::max(fewest_fits, (off_shares.size() + 2) / 3);
  std::vector<char> often_off(count, 0);
  for (std::size_t i = 0; i < count; ++i) often_off[i] = off[i] >= enough ? 1 : 0;
  SamePlace largest;
  for (auto& patch : patches_of(topology, std::move(often_off)))
    if (patch.size() > largest.vertices.size()) largest.vertices = std::move(patch);
  if (static_cast<double>(largest.vertices.size()) < fewest_vertices * static_cast<double>(count)) return std::nullopt;
  for (const VertexScalars& one : off_shares) {
    const auto here = std::count_if(largest.vertices.begin(), largest.vertices.end(),
                                    [&](std::int32_t i) { return one[i] > off_share; });
    largest.fits += 2 * here >= std::ssize(largest.vertices) ? 1 : 0;
  }
  return largest;
}

}  // namespace homolog
