#include "core/adapt/fitting.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/adapt/boundary/landmark_pull.h"
#include "core/adapt/boundary/mirrored_landmarks.h"
#include "core/adapt/fit_doubt.h"
#include "core/adapt/match/coherent_match.h"
#include "core/adapt/partial_ways.h"
#include "core/adapt/roundness.h"
#include "core/adapt/slide_doubt.h"
#include "core/adapt/untangle.h"
#include "core/base/statistics.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/remesh.h"
#include "core/mesh/surface_search.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr Annealing from_placement{.steps = 16, .softest_edges = 1},
    from_match{.steps = 10, .softest_edges = 1, .stiffest_share = 0.05};
/// Times the strain of the plain fit: a match counts in full up to the first, and from the second on it is wrong.
constexpr double full_strain_ratio = 1.6, most_strain_ratio = 2;
/// Matches are averaged by the inverse of their energy to this power. It is the strain, and this many times the mean
/// square by which they are off the boundary, as a share of its area.
constexpr double less_energy_counts = 12, off_counts = 1000;
/// A boundary is worked out on voxels of a third of a mean edge [label_boundary]. Rounding to these is off by this
/// share of an edge, root mean square. A match that is no farther off leaves nothing to explain.
constexpr double rounded_edges = 0.0962;  // 1 / (3 √12)
/// Times that, as squares: beyond, as much is unexplained as rounding makes, and the match tells nothing.
constexpr double most_unexplained = 2;
constexpr double told_if_smooth = 0.5;  ///< of the doubt that is due to roundness, how much such a match takes away
/// Of the work after the ways: their mean, that with the plain fit, and the slide.
constexpr std::size_t finishing_parts = 3;
constexpr double about_as_likely = 1.15;  ///< times the least energy of the ways onto what is there

/// What is in one list or in both. Both ascend.
std::vector<std::int32_t> either(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  std::vector<std::int32_t> both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

/// Of a match, by its strain over that of the plain fit: 0 wrong … 1.
double believed(double strain_ratio) {
  return std::clamp((most_strain_ratio - strain_ratio) / (most_strain_ratio - full_strain_ratio), 0.0, 1.0);
}

}  // namespace

Fitting::Fitting(const Template& the_template, const Boundary& boundary, const FitOptions& options)
    : reference_(the_template),
      boundary_(boundary),
      options_(options),
      round_(roundness({the_template.topology, the_template.points})),
      search_(boundary, the_template.points.rows()),
      adaptation_(the_template, boundary, search_, options,
                  [this](const Points& points, double done) { return show(points, done); }) {
  shape_.factors = the_template.stiffness / the_template.stiffness.mean();
}

Result<void> Fitting::to_boundary(std::vector<Points> about_right) {
  about_right_ = std::move(about_right);
  if (auto placed = place(); !placed) return placed;
  return options_.partial ? adapt_to_parts() : adapt_from_starts();
}

Points Fitting::form_placed() const {
  return nearest_similarity(reference_.points, shape_.mesh.points, shape_.placement).apply(reference_.points);
}

FitResult Fitting::finish() {
  Mesh& mesh = shape_.mesh;
  FitResult result;
  result.placement = nearest_similarity(reference_.points, mesh.points, shape_.placement);
  result.turned_triangles =
      turned_triangles(*mesh.topology, result.placement.apply(reference_.points), mesh.points).size();
  result.self_intersections = self_intersections(mesh).size();
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    if (!boundary_.shows(mesh.points.row(i))) result.unseen.push_back(static_cast<std::int32_t>(i));
  result.outliers = lacking_;
  result.landmarks = carried_landmarks(reference_, mesh.points);
  result.landmarks_used = static_cast<std::size_t>((trust_.array() >= believable).count());
  result.landmarks_place = result.landmarks_used >= static_cast<std::size_t>(fewest_placing_landmarks);
  if (options_.rough) {
    result.mesh = std::move(mesh);
    return result;
  }
  const bool told = result.landmarks_place || options_.allowed;
  VertexScalars spread = spread_mm2();
  const bool axes_count = options_.orientation == Orientation::patient && !options_.placement;
  if (const auto other = other_lie(reference_, boundary_, options_.orientation, axes_count, options_.partial)) {
    result.half_turned = other->half_turned;
    result.mirrored = !other->half_turned;
    spread += (other->points - mesh.points).rowwise().squaredNorm();
  }
  result.doubt_mm = fit_doubt_mm(mesh, spread, ways_.empty() ? adaptation_.strain(shape_) : ways_.front().strain,
                                 told ? 0 : round_ - told_if_smooth * smooth_, either(result.outliers, result.unseen),
                                 shares_of_sliding(mesh));
  result.warnings = std::move(landmark_warnings_);
  result.mesh = std::move(mesh);
  return result;
}

Result<FitResult> Fitting::among_allowed(std::vector<std::int32_t> lacking) {
  lacking_ = std::move(lacking);
  if (auto placed = place(); !placed) return fail(placed.error());
  const auto forces = [this](const Mesh& mesh, double share) {
    shape_.mesh = mesh;
    return adaptation_.force(mesh, found_, share);
  };
  const auto after_step = [this](double share) { return show(shape_.mesh.points, 0.1 + 0.4 * share); };
  const auto found = fit_allowed(*options_.allowed, reference_.topology, found_, forces, after_step);
  if (!found) return fail(found.error());
  shape_.mesh.points = found->points;
  shape_.placement = found->placement;
  shape_.rest = found->shape;
  shape_.refit();
  if (options_.partial) lacking_ = either(lacking_, beyond_noise({reference_.topology, found->points}));
  const double beyond = options_.allowed->beyond;
  if (beyond > 0) {
    if (auto done = adaptation_.anneal_to_boundary(shape_, from_placement); !done) return fail(done.error());
    if (auto done = adaptation_.settle(shape_); !done) return fail(done.error());
  }
  if (beyond < 1) {
    shape_.mesh.points = found->points + beyond * (shape_.mesh.points - found->points);
    shape_.refit();
    if (beyond > 0) untangle(shape_.mesh, shape_.placed, shape_.factors);
  }
  if (beyond > 0 && !lacking_.empty()) {
    keep_where_lacking(found->points);
    untangle(shape_.mesh, shape_.placed, shape_.factors);
  }
  FitResult result = finish();
  result.allowed = found->points;
  return result;
}

std::vector<std::int32_t> Fitting::beyond_noise(const Mesh& mesh) {
  constexpr double noise_counts = 3, normal_median = 0.6745;
  const double size_mm = bounds_of(mesh.points).diagonal().norm();
  search_.set_reach_mm(size_mm);
  const BoundaryPull pull = search_.nearest(mesh);
  std::vector<double> off_mm;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    if (pull.weights[i] > 0) off_mm.push_back((pull.targets.row(i) - mesh.points.row(i)).norm());
  if (off_mm.empty()) return search_.missing(mesh);
  search_.set_reach_mm(std::max(closest_reach * size_mm, noise_counts / normal_median * quantile(off_mm, 0.5)));
  return search_.missing(mesh);
}

void Fitting::keep_where_lacking(const Points& likely) {
  constexpr int rings = 3;
  VertexScalars kept = VertexScalars::Zero(likely.rows());
  for (const std::int32_t i : lacking_) kept[i] = 1;
  const VertexScalars all = kept;
  for (int ring = 0; ring < rings; ++ring) {
    const VertexScalars before = kept;
    for (Eigen::Index i = 0; i < kept.size(); ++i) {
      double sum = before[i], count = 1;
      for (const std::int32_t j : reference_.topology->one_ring(i)) sum += before[j], ++count;
      kept[i] = std::max(all[i], sum / count);
    }
  }
  shape_.mesh.points += kept.asDiagonal() * (likely - shape_.mesh.points);
  shape_.refit();
}

Result<void> Fitting::place() {
  const auto [own, there] = matched_landmarks(reference_, options_.landmarks);
  if (options_.placement) {
    const Points placed = options_.placement->apply(reference_.points);
    if (!bounds_of(placed).intersects(bounds_of(boundary_.surface.points)))
      return fail(
          "", "the placement puts the template beside the organ; correct it, or leave it out to let the fit find one");
  }
  const Placed found = find_placement(reference_, boundary_,
                                      {options_.landmarks, options_.orientation, options_.placement, options_.partial});
  found_ = shape_.placement = found.placement;
  trust_ = found.trust.size() == own.rows() ? found.trust : VertexScalars::Ones(own.rows());
  adaptation_.trust(trust_);
  landmark_warnings_ =
      warnings_of_landmarks(reference_, options_.landmarks, trust_, (found_.apply(own) - there).rowwise().norm());
  const Points placed = found_.apply(reference_.points);
  if (options_.allowed) {
    shape_.mesh = {reference_.topology, placed};
    return show(placed, 0.1);
  }
  know_landmarks(placed, found_.apply(own), there);
  shape_.mesh = {reference_.topology,
                 warp_to_boundary(reference_.topology, placed, landmarks_, whole() ? round_ : 0, search_)};
  if (!shape_.mesh.points.allFinite() || !(found_.scale > 0))
    return fail("", "the template cannot be placed on the surface: one of them is flat or has no size; check both");
  return show(shape_.mesh.points, 0);
}

void Fitting::know_landmarks(const Points& placed, const Points& from, const Points& to) {
  landmarks_ = known_matches(placed, from, to, trust_);
  for (std::size_t k = 0; k < reference_.landmarks.size(); ++k)
    if (options_.landmarks.contains(reference_.landmarks[k].name))
      landmark_places_.push_back(reference_.landmark_points[k]);
  if (!whole() || !warped()) return;
  const auto mirrored = mirrored_landmarks(reference_, boundary_, options_.landmarks, trust_, found_);
  add_mirrored(mirrored, {reference_.topology, placed}, landmarks_);
  for (const MirroredLandmark& one : mirrored) landmark_places_.push_back(one.place);
}

KnownMatches Fitting::known_on(const Points& points) const {
  KnownMatches known = landmarks_;
  for (std::size_t k = 0; k < landmark_places_.size(); ++k)
    known.from.row(static_cast<Eigen::Index>(k)) = landmark_places_[k].interpolate(*reference_.topology, points);
  return known;
}

std::vector<Fitting::Start> Fitting::starts() const {
  std::vector<Start> all{{shape_.mesh.points}};
  if (!(whole() || matches_beyond_cuts_) || options_.rough) return all;
  const KnownMatches known = known_on(shape_.mesh.points);
  const CoherentMatch coherent(reference_.points, shape_.mesh, boundary_.surface);
  // A template without extent in some direction has no smooth displacement.
  const auto add = [&](Points points) {
    if (points.allFinite()) all.push_back({std::move(points), true});
  };
  for (const MatchFreedom& freedom : {loose_match, close_match}) {
    CoherentMatch::Ways ways = coherent.match(freedom, known);
    if (warped()) {  // the landmarks have set the whole right, and what differs is averaged best at the end
      add(std::move(ways.forth));
      add(std::move(ways.back));
    } else {
      add(ways.mean());
    }
  }
  return all;
}

Result<void> Fitting::adapt_to_parts() {
  PartialWays ways(reference_, boundary_, search_, adaptation_,
                   [this](const Points& placed) { return known_on(placed); });
  part_of_progress_ = {0, 2 + about_right_.size()};
  const auto next = [this](Result<void> done) {
    ++part_of_progress_.first;
    return done;
  };
  if (auto done = next(ways.from_placement(shape_.mesh.points, found_)); !done) return done;
  for (const Points& mesh : about_right_)
    if (auto done = next(ways.from_mesh(mesh)); !done) return done;
  if (auto done = ways.from_match(); !done) return done;
  auto closest = ways.closest();
  if (!closest) return fail(closest.error());
  const PartialWay& best = ways.tried().front();
  for (const PartialWay& one : ways.tried())
    if (one.energy <= about_as_likely * best.energy) ways_.push_back(one.way);
  ways_.push_back(*closest);
  lacking_ = best.missing;
  shape_ = closest->shape;
  shape_.rest = reference_.points;
  if (lacking_.empty()) return {};
  keep_where_lacking(best.way.shape.mesh.points);
  untangle(shape_.mesh, shape_.placed, shape_.factors);
  return {};
}

Result<void> Fitting::adapt_from_starts() {
  const std::vector<Start> all = starts();
  part_of_progress_ = {0, all.size() + finishing_parts};
  for (const Start& start : all) {
    auto adapted = adapt(start, found_);
    if (!adapted) return fail(adapted.error());
    ways_.push_back(std::move(*adapted));
    ++part_of_progress_.first;
  }
  const Adapted& plain = ways_.front();
  shape_ = plain.shape;
  if (ways_.size() == 1) return {};
  // Of a round organ the plain fit varies least from case to case, and models of it generalise better. But where a
  // smooth displacement tells all, that says where vertices belong.
  const double smooth = round_ > 0 ? round_ * differs_smoothly(all.back()) : 0, vague = round_ - smooth;
  if (vague == 1 && !warped()) return {};
  // Landmarks have told all ways where things belong. So on a round organ the plain fit counts like the others.
  const auto mean = mean_way(warped() ? round_ : 0);
  if (!mean) return {};
  Adapting matched = shape_;
  matched.mesh.points = *mean;
  if (smooth > 0) {
    const Points warped = warp_along_boundary(matched.mesh, found_.apply(reference_.points), landmarks_, search_);
    matched.mesh.points = smooth * warped + (1 - smooth) * matched.mesh.points;
  }
  if (auto done = adaptation_.settle_as_it_is(matched); !done) return done;
  ++part_of_progress_.first;
  const double share =
      warped() ? 1 : (1 - vague) * std::max(smooth, believed(adaptation_.strain(matched) / plain.strain));
  if (share == 0) return {};
  if (share < 1) {
    matched.mesh.points = share * matched.mesh.points + (1 - share) * plain.shape.mesh.points;
    if (auto done = adaptation_.settle_as_it_is(matched); !done) return done;
  }
  ++part_of_progress_.first;
  shape_ = std::move(matched);
  smooth_ = smooth;
  // Much of a round organ faces about the same way, and cases would vary more.
  return round_ == 1 ? Result<void>{} : adaptation_.slide_to_facing(shape_, 1 - round_);
}

double Fitting::differs_smoothly(const Start& match) {
  const double edge_mm = spread_edge_mm(surface_area_mm2(boundary_.surface), reference_.points.rows()),
               off = adaptation_.off_mm2({reference_.topology, match.points}) / std::pow(rounded_edges * edge_mm, 2);
  return std::clamp((most_unexplained - off) / (most_unexplained - 1), 0.0, 1.0);
}

std::optional<Points> Fitting::mean_way(double plain_counts) const {
  const Adapted& plain = ways_.front();
  const double most_off_mm = adaptation_.most_off_mm(plain.off_mm2), area_mm2 = surface_area_mm2(boundary_.surface);
  const auto counts = [&](const Adapted& way) {
    if (!(std::sqrt(way.off_mm2) <= most_off_mm && way.strain > 0)) return 0.0;
    if (&way == &plain) return plain_counts;
    return warped() ? believed(way.strain / plain.strain) : 1.0;
  };
  const auto energy = [&](const Adapted& way) { return way.strain + off_counts * way.off_mm2 / area_mm2; };
  double least = std::numeric_limits<double>::infinity();
  for (const Adapted& way : ways_)
    if (counts(way) > 0) least = std::min(least, energy(way));
  Points sum = Points::Zero(reference_.points.rows(), 3);
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

Result<Adapted> Fitting::adapt(const Start& start, const Similarity& placement) {
  // A match is its own reference: the template's proportions would draw it back off small features.
  return adaptation_.adapt(start.points, placement,
                           start.matched || warped() ? adaptation_.unplaced(start.points) : reference_.points,
                           start.matched ? from_match : from_placement);
}

VertexScalars Fitting::spread_mm2() const {
  VertexScalars sum = VertexScalars::Zero(shape_.mesh.points.rows());
  int others = 0;
  for (const Adapted& way : ways_) {
    if (way.shape.mesh.points == shape_.mesh.points) continue;  // the way that was kept
    sum += (way.shape.mesh.points - shape_.mesh.points).rowwise().squaredNorm();
    ++others;
  }
  return sum / std::max(others, 1);
}

Result<void> Fitting::show(const Points& points, double done) {
  if (options_.show) options_.show(points);
  if (options_.progress == nullptr) return {};
  const auto [part, parts] = part_of_progress_;
  options_.progress->report((static_cast<double>(part) + done) / static_cast<double>(parts));
  return options_.progress->cancelled() ? Result<void>(fail("", "the fit was cancelled")) : Result<void>{};
}

}  // namespace homolog
