#include "core/adapt/ways/whole_ways.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/adapt/boundary/boundary_warp.h"
#include "core/adapt/boundary/rim_matches.h"
#include "core/adapt/match/coherent_match.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr Annealing from_match{.steps = 10, .softest_edges = 1, .stiffest_share = 0.05};
/// Times the strain of the plain way: a match counts in full up to the first, and from the second on it is wrong.
constexpr double full_strain_ratio = 1.6, most_strain_ratio = 2;
/// Matches are averaged by the inverse of their energy to this power. It is the strain, and this many times the mean
/// square by which they are off the boundary, as a share of its area.
constexpr double less_energy_counts = 12, off_counts = 1000;
/// A boundary is worked out on voxels of a third of a mean edge [label_boundary]. Rounding to these is off by this
/// share of an edge, root mean square. A match that is no farther off leaves nothing to explain.
constexpr double rounded_edges = 0.0962;  // 1 / (3 √12)
/// Times that, as squares: beyond, as much is unexplained as rounding makes, and the match tells nothing.
constexpr double most_unexplained = 2;
/// Parts of the work after the ways: their mean, that with the plain way, and the slide.
constexpr std::size_t finishing_parts = 3;

/// The belief in a match, by its strain over that of the plain way: 0 wrong … 1.
double believed(double strain_ratio) {
  return std::clamp((most_strain_ratio - strain_ratio) / (most_strain_ratio - full_strain_ratio), 0.0, 1.0);
}

}  // namespace

Result<void> WholeWays::go(const Points& start, bool match) {
  std::vector<Start> all = starts(start, match);
  fit_.parts = {0, all.size() + finishing_parts};
  for (const Start& one : all) {
    auto way = from(one);
    if (!way) return fail(way.error());
    ways_.push_back(std::move(*way));
    ++fit_.parts.done;
  }
  if (all.back().matched) last_match_ = std::move(all.back().points);
  return {};
}

Result<Adapting> WholeWays::kept() {
  const Adapted& plain = ways_.front();
  if (ways_.size() == 1) return plain.shape;
  const bool by_landmarks = fit_.placed.by_landmarks();
  // Of a round organ the plain way varies least from case to case, and models of it generalise better. But where a
  // smooth displacement tells all, that says where vertices belong.
  const double smooth = fit_.roundness > 0 ? fit_.roundness * differs_smoothly() : 0, vague = fit_.roundness - smooth;
  if (vague == 1 && !by_landmarks) return plain.shape;
  // Landmarks have told all ways where things belong. So on a round organ the plain way counts like the others.
  const auto mean = mean_way(by_landmarks ? fit_.roundness : 0);
  if (!mean) return plain.shape;
  Adapting matched = plain.shape;
  matched.mesh.points = *mean;
  if (smooth > 0) {
    const KnownMatches known =
        with_rims(fit_.placed.landmarks, matched.mesh, RimsLie::on_each_other, fit_.placed.points, fit_.target);
    const Points warped = warp_along_boundary(matched.mesh, fit_.placed.points, known, fit_.target);
    matched.mesh.points = smooth * warped + (1 - smooth) * matched.mesh.points;
  }
  if (auto done = fit_.steps.settle_as_it_is(matched); !done) return fail(done.error());
  ++fit_.parts.done;
  const double share =
      by_landmarks ? 1 : (1 - vague) * std::max(smooth, believed(fit_.steps.strain(matched) / plain.strain));
  if (share == 0) return plain.shape;
  if (share < 1) {
    matched.mesh.points = share * matched.mesh.points + (1 - share) * plain.shape.mesh.points;
    if (auto done = fit_.steps.settle_as_it_is(matched); !done) return fail(done.error());
  }
  ++fit_.parts.done;
  smooth_ = smooth;
  // Much of a round organ faces about the same way, and cases would vary more.
  if (fit_.roundness < 1)
    if (auto done = fit_.steps.slide_to_facing(matched, fit_.target.surface(), 1 - fit_.roundness); !done)
      return fail(done.error());
  return matched;
}

std::vector<WholeWays::Start> WholeWays::starts(const Points& start, bool match) const {
  std::vector<Start> all{{start}};
  if (!match) return all;
  const KnownMatches known = with_rims(fit_.placed.known_on(*fit_.the_template.topology, start),
                                       {fit_.the_template.topology, start}, RimsLie::near, start, fit_.target);
  const CoherentMatch coherent(fit_.the_template.points, {fit_.the_template.topology, start}, fit_.target.surface());
  // A template without extent in some direction has no smooth displacement.
  const auto add = [&](Points points) {
    if (points.allFinite()) all.push_back({std::move(points), true});
  };
  for (const MatchFreedom& freedom : {loose_match, close_match}) {
    CoherentMatch::Ways ways = coherent.match(freedom, known);
    if (fit_.placed.by_landmarks()) {  // they have set the whole right, and what differs is averaged best at the end
      add(std::move(ways.forth));
      add(std::move(ways.back));
    } else {
      add(ways.mean());
    }
  }
  return all;
}

Result<Adapted> WholeWays::from(const Start& start) {
  // A match is its own reference: the template's proportions would draw it back off small features.
  const bool own_reference = start.matched || fit_.placed.by_landmarks();
  return fit_.steps.adapt(start.points, fit_.placed.placement,
                          own_reference ? fit_.steps.unplaced(start.points) : fit_.the_template.points,
                          start.matched ? from_match : from_placement);
}

double WholeWays::differs_smoothly() const {
  const double edge_mm = spread_edge_mm(surface_area_mm2(fit_.target.surface()), fit_.the_template.points.rows()),
               off = fit_.target.off_mm2({fit_.the_template.topology, last_match_}) /
                     std::pow(rounded_edges * edge_mm, 2);
  return std::clamp((most_unexplained - off) / (most_unexplained - 1), 0.0, 1.0);
}

std::optional<Points> WholeWays::mean_way(double plain_counts) const {
  const Adapted& plain = ways_.front();
  const double most_off_mm = fit_.steps.most_off_mm(plain.off_mm2), area_mm2 = surface_area_mm2(fit_.target.surface());
  const auto counts = [&](const Adapted& way) {
    if (!(std::sqrt(way.off_mm2) <= most_off_mm && way.strain > 0)) return 0.0;
    if (&way == &plain) return plain_counts;
    return fit_.placed.by_landmarks() ? believed(way.strain / plain.strain) : 1.0;
  };
  const auto energy = [&](const Adapted& way) { return way.strain + off_counts * way.off_mm2 / area_mm2; };
  double least = std::numeric_limits<double>::infinity();
  for (const Adapted& way : ways_)
    if (counts(way) > 0) least = std::min(least, energy(way));
  Points sum = Points::Zero(fit_.the_template.points.rows(), 3);
  double weights = 0;
  for (const Adapted& way : ways_) {
    if (counts(way) == 0) continue;
    const double weight = counts(way) * std::pow(least / energy(way), less_energy_counts);
    sum += weight * way.shape.mesh.points;
    weights += weight;
  }
  if (weights == 0) return std::nullopt;
  return sum / weights;
}

}  // namespace homolog
