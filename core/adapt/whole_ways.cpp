#include "core/adapt/whole_ways.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/adapt/boundary/boundary_warp.h"
#include "core/adapt/match/coherent_match.h"
#include "core/mesh/construction/remesh.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/rims.h"

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
/// Of the work after the ways: their mean, that with the plain way, and the slide.
constexpr std::size_t finishing_parts = 3;

/// Of a match, by its strain over that of the plain way: 0 wrong … 1.
double believed(double strain_ratio) {
  return std::clamp((most_strain_ratio - strain_ratio) / (most_strain_ratio - full_strain_ratio), 0.0, 1.0);
}

}  // namespace

KnownMatches with_rims(KnownMatches known, const Mesh& mesh, RimsLie rims_lie, const Points& from,
                       const Boundary& boundary, Target& target) {
  if (long_rims(boundary.surface).empty()) return known;
  constexpr double noise_share = 0.015;                           // of the diagonal
  const double as_sure_as = rims_lie == RimsLie::near ? 10 : 40;  // of so many places
  constexpr std::size_t most_places = 200;                        // the time goes by their number to the third power
  const std::vector<Rim> rims = long_rims(mesh);
  std::size_t vertices = 0;
  for (const Rim& rim : rims) vertices += rim.size();
  const std::size_t step = std::max<std::size_t>(1, (vertices + most_places - 1) / most_places);
  std::vector<std::int32_t> on_rim;
  for (const Rim& rim : rims)
    for (std::size_t k = 0; k < rim.size(); k += step) on_rim.push_back(rim[k]);
  if (on_rim.empty()) return known;
  const Points to = target.nearest(mesh).targets(on_rim, Eigen::all);
  const auto count = std::ssize(on_rim);
  // What they are off by along the rim they share, so that many tell no more than some.
  const double noise_mm = noise_share * bounds_of(mesh.points).diagonal().norm() *
                          std::sqrt(std::max(1.0, static_cast<double>(count) / as_sure_as));
  KnownMatches all{Points(known.from.rows() + count, 3), Points(known.from.rows() + count, 3),
                   VertexScalars(known.from.rows() + count)};
  all.from << known.from, from(on_rim, Eigen::all);
  all.to << known.to, to;
  all.noise_mm << known.noise_mm, VertexScalars::Constant(count, noise_mm);
  return all;
}

WholeWays::WholeWays(const Template& the_template, const Boundary& boundary, Target& target, FitSteps& steps,
                     const PlacedTemplate& placed, double roundness, PartsOfWork& parts)
    : template_(the_template),
      boundary_(boundary),
      target_(target),
      steps_(steps),
      placed_(placed),
      round_(roundness),
      parts_(parts) {}

Result<void> WholeWays::go(const Points& start, bool match) {
  std::vector<Start> all = starts(start, match);
  parts_ = {0, all.size() + finishing_parts};
  for (const Start& one : all) {
    auto way = from(one);
    if (!way) return fail(way.error());
    ways_.push_back(std::move(*way));
    ++parts_.done;
  }
  if (all.back().matched) last_match_ = std::move(all.back().points);
  return {};
}

Result<Adapting> WholeWays::kept() {
  const Adapted& plain = ways_.front();
  if (ways_.size() == 1) return plain.shape;
  const bool by_landmarks = placed_.by_landmarks();
  // Of a round organ the plain way varies least from case to case, and models of it generalise better. But where a
  // smooth displacement tells all, that says where vertices belong.
  const double smooth = round_ > 0 ? round_ * differs_smoothly() : 0, vague = round_ - smooth;
  if (vague == 1 && !by_landmarks) return plain.shape;
  // Landmarks have told all ways where things belong. So on a round organ the plain way counts like the others.
  const auto mean = mean_way(by_landmarks ? round_ : 0);
  if (!mean) return plain.shape;
  Adapting matched = plain.shape;
  matched.mesh.points = *mean;
  if (smooth > 0) {
    const KnownMatches known =
        with_rims(placed_.landmarks, matched.mesh, RimsLie::on_each_other, placed_.points, boundary_, target_);
    const Points warped = warp_along_boundary(matched.mesh, placed_.points, known, target_);
    matched.mesh.points = smooth * warped + (1 - smooth) * matched.mesh.points;
  }
  if (auto done = steps_.settle_as_it_is(matched); !done) return fail(done.error());
  ++parts_.done;
  const double share =
      by_landmarks ? 1 : (1 - vague) * std::max(smooth, believed(steps_.strain(matched) / plain.strain));
  if (share == 0) return plain.shape;
  if (share < 1) {
    matched.mesh.points = share * matched.mesh.points + (1 - share) * plain.shape.mesh.points;
    if (auto done = steps_.settle_as_it_is(matched); !done) return fail(done.error());
  }
  ++parts_.done;
  smooth_ = smooth;
  // Much of a round organ faces about the same way, and cases would vary more.
  if (round_ < 1)
    if (auto done = steps_.slide_to_facing(matched, boundary_.surface, 1 - round_); !done) return fail(done.error());
  return matched;
}

std::vector<WholeWays::Start> WholeWays::starts(const Points& start, bool match) const {
  std::vector<Start> all{{start}};
  if (!match) return all;
  const KnownMatches known = with_rims(placed_.known_on(*template_.topology, start), {template_.topology, start},
                                       RimsLie::near, start, boundary_, target_);
  const CoherentMatch coherent(template_.points, {template_.topology, start}, boundary_.surface);
  // A template without extent in some direction has no smooth displacement.
  const auto add = [&](Points points) {
    if (points.allFinite()) all.push_back({std::move(points), true});
  };
  for (const MatchFreedom& freedom : {loose_match, close_match}) {
    CoherentMatch::Ways ways = coherent.match(freedom, known);
    if (placed_.by_landmarks()) {  // they have set the whole right, and what differs is averaged best at the end
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
  const bool own_reference = start.matched || placed_.by_landmarks();
  return steps_.adapt(start.points, placed_.placement, own_reference ? steps_.unplaced(start.points) : template_.points,
                      start.matched ? from_match : from_placement);
}

double WholeWays::differs_smoothly() const {
  const double edge_mm = spread_edge_mm(surface_area_mm2(boundary_.surface), template_.points.rows()),
               off = target_.off_mm2({template_.topology, last_match_}) / std::pow(rounded_edges * edge_mm, 2);
  return std::clamp((most_unexplained - off) / (most_unexplained - 1), 0.0, 1.0);
}

std::optional<Points> WholeWays::mean_way(double plain_counts) const {
  const Adapted& plain = ways_.front();
  const double most_off_mm = steps_.most_off_mm(plain.off_mm2), area_mm2 = surface_area_mm2(boundary_.surface);
  const auto counts = [&](const Adapted& way) {
    if (!(std::sqrt(way.off_mm2) <= most_off_mm && way.strain > 0)) return 0.0;
    if (&way == &plain) return plain_counts;
    return placed_.by_landmarks() ? believed(way.strain / plain.strain) : 1.0;
  };
  const auto energy = [&](const Adapted& way) { return way.strain + off_counts * way.off_mm2 / area_mm2; };
  double least = std::numeric_limits<double>::infinity();
  for (const Adapted& way : ways_)
    if (counts(way) > 0) least = std::min(least, energy(way));
  Points sum = Points::Zero(template_.points.rows(), 3);
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
