#include "core/adapt/ways/partial_ways.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/adapt/boundary/partial_placements.h"
#include "core/adapt/match/coherent_match.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

/// A softer shape shrinks into what is there.
constexpr Annealing from_placement_of_parts{.steps = 16, .softest_edges = 2},
    from_mesh_of_parts{.steps = 10, .softest_edges = 2, .stiffest_share = 0.1},
    from_own_match{.steps = 10, .softest_edges = 1, .stiffest_share = 0.05};
constexpr double unexplained_counts = 1000;  ///< times its mean square, as a share of the boundary's area
constexpr double least_there = 0.01;         ///< share of the vertices

/// Mean square distance of the boundary's own places from a mesh. A tenth of them may lie on cuts or patches not known
/// to be such; the farthest ones do not count.
double unexplained_mm2(const Boundary& boundary, const Mesh& mesh) {
  constexpr Eigen::Index enough = 5000;
  constexpr double counted = 0.9;
  const Points& points = boundary.surface.points;
  const SurfaceSearch search(mesh);
  std::vector<double> each_mm2;
  for (Eigen::Index i = 0; i < points.rows(); i += 1 + points.rows() / enough) {
    const Vec3 place = points.row(i);
    if (!boundary.shows(place) || !boundary.is_own(boundary.surface.topology->faces_of(i).front())) continue;
    each_mm2.push_back((search.nearest(place).position - place).squaredNorm());
  }
  std::sort(each_mm2.begin(), each_mm2.end());
  each_mm2.resize(static_cast<std::size_t>(counted * static_cast<double>(each_mm2.size())));
  return each_mm2.empty()
             ? 0
             : std::accumulate(each_mm2.begin(), each_mm2.end(), 0.0) / static_cast<double>(each_mm2.size());
}

}  // namespace

PartialWays::PartialWays(const FitContext& fit) : fit_(fit), area_mm2_(surface_area_mm2(fit.target.surface())) {}

Result<void> PartialWays::add(Result<Adapted> way) {
  if (!way) return fail(way.error());
  std::vector<std::int32_t> missing = fit_.target.missing(way->shape.mesh);
  const double there = 1 - static_cast<double>(missing.size()) / static_cast<double>(fit_.the_template.points.rows());
  const double energy = way->strain / std::max(there, least_there) +
                        unexplained_counts * unexplained_mm2(fit_.target.boundary(), way->shape.mesh) / area_mm2_;
  const auto worse =
      std::find_if(tried_.begin(), tried_.end(), [energy](const PartialWay& one) { return energy < one.energy; });
  tried_.insert(worse, {std::move(*way), std::move(missing), energy});
  return {};
}

Result<void> PartialWays::from_placement(const Points& start, const Similarity& placement) {
  const auto from = [&](const Points& points, const Similarity& placed) {
    return add(fit_.steps.adapt(points, placed, fit_.the_template.points, from_placement_of_parts));
  };
  if (auto done = from(start, placement); !done) return done;
  const PartialWay& first = tried_.front();
  VertexScalars missing = VertexScalars::Zero(fit_.the_template.points.rows());
  for (const std::int32_t i : first.missing) missing[i] = 1;
  for (const Similarity& other : placements_towards(placement, first.way.shape.mesh.points, missing))
    if (auto done = from(other.apply(fit_.the_template.points), other); !done) return done;
  return {};
}

Result<void> PartialWays::from_mesh(const Points& mesh) {
  // What lacks may have been drawn into what is there, and would not find out of it.
  Points points = mesh;
  const std::vector<std::int32_t> missing = fit_.target.missing({fit_.the_template.topology, mesh});
  const Similarity placement = placement_of_rest(mesh, missing);
  for (const std::int32_t i : missing) points.row(i) = placement.apply(Points(fit_.the_template.points.row(i)));
  return add(fit_.steps.adapt(points, placement, fit_.the_template.points, from_mesh_of_parts));
}

Similarity PartialWays::placement_of_rest(const Points& mesh, const std::vector<std::int32_t>& missing) const {
  std::vector<Eigen::Index> there;
  auto next = missing.begin();
  for (Eigen::Index i = 0; i < mesh.rows(); ++i) {
    if (next != missing.end() && *next == i)
      ++next;
    else
      there.push_back(i);
  }
  return nearest_similarity(Points(fit_.the_template.points(there, Eigen::all)), Points(mesh(there, Eigen::all)),
                            nearest_similarity(fit_.the_template.points, mesh, {}));
}

Points PartialWays::matched() const {
  const PartialWay& best = tried_.front();
  const Mesh placed{fit_.the_template.topology,
                    placement_of_rest(best.way.shape.mesh.points, best.missing).apply(fit_.the_template.points)};
  return CoherentMatch(fit_.the_template.points, placed, fit_.target.surface())
      .match(close_match, fit_.placed.known_on(*fit_.the_template.topology, placed.points))
      .forth;
}

Result<void> PartialWays::from_match() {
  const Points points = matched();
  return points.allFinite() ? from_mesh(points) : Result<void>{};
}

Result<Adapted> PartialWays::closest() {
  const Points points = matched();
  if (!points.allFinite()) return tried_.front().way;
  return fit_.steps.adapt(points, nearest_similarity(fit_.the_template.points, points, {}), fit_.steps.unplaced(points),
                          from_own_match);
}

}  // namespace homolog
