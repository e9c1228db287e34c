#include "core/adapt/ways/fitting.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/adapt/boundary/boundary_warp.h"
#include "core/adapt/boundary/landmark_pull.h"
#include "core/adapt/boundary/rim_matches.h"
#include "core/adapt/fit_doubt.h"
#include "core/adapt/untangle.h"
#include "core/adapt/ways/partial_ways.h"
#include "core/adapt/ways/whole_ways.h"
#include "core/base/numbers/statistics.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr double told_if_smooth = 0.5;    ///< share of the doubt due to roundness: how much such a match takes away
constexpr double about_as_likely = 1.15;  ///< times the least energy of the ways onto what is there

/// All that is in one list or in both. Both ascend.
std::vector<std::int32_t> either(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  std::vector<std::int32_t> both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

}  // namespace

Fitting::Fitting(const Template& the_template, const Boundary& boundary, const FitOptions& options)
    : template_(the_template),
      options_(options),
      round_(roundness({the_template.topology, the_template.points})),
      target_(boundary, the_template.points.rows(), options.partial),
      steps_(the_template, target_, options, [this](const Points& points, double done) { return show(points, done); }) {
  shape_.factors = the_template.stiffness / the_template.stiffness.mean();
}

Result<void> Fitting::to_boundary(std::vector<Points> about_right) {
  about_right_ = std::move(about_right);
  if (auto placed = place(); !placed) return placed;
  return options_.partial ? adapt_to_parts() : adapt_to_whole();
}

Points Fitting::form_placed() const {
  return nearest_similarity(template_.points, shape_.mesh.points, shape_.placement).apply(template_.points);
}

FitResult Fitting::finish() {
  Mesh& mesh = shape_.mesh;
  FitResult result;
  result.placement = nearest_similarity(template_.points, mesh.points, shape_.placement);
  result.turned_triangles =
      turned_triangles(*mesh.topology, result.placement.apply(template_.points), mesh.points).size();
  result.self_intersections = self_intersections(mesh).size();
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    if (!target_.boundary().shows(mesh.points.row(i))) result.unseen.push_back(static_cast<std::int32_t>(i));
  result.outliers = lacking_;
  result.landmarks = carried_landmarks(template_, mesh.points);
  result.believed = believed_landmarks(template_, options_.landmarks, placed_.trust);
  result.landmarks_used = result.believed.size();
  result.landmarks_place = result.landmarks_used >= static_cast<std::size_t>(fewest_placing_landmarks);
  if (options_.rough) {
    result.mesh = std::move(mesh);
    return result;
  }
  const bool told = result.landmarks_place || options_.allowed;
  VertexScalars spread = spread_mm2();
  const bool axes_count = options_.orientation == Orientation::patient && !options_.placement;
  const auto other = other_lie(template_, target_.boundary(), options_.orientation, axes_count, options_.partial);
  if (other && (options_.has_side || other->half_turned)) {
    result.half_turned = other->half_turned;
    result.mirrored = !other->half_turned;
    spread += (other->points - mesh.points).rowwise().squaredNorm();
  }
  result.doubt_mm = fit_doubt_mm(mesh, {.spread_mm2 = std::move(spread),
                                        .strain = ways_.empty() ? steps_.strain(shape_) : ways_.front().strain,
                                        .roundness = told ? 0 : round_ - told_if_smooth * smooth_,
                                        .missing = either(result.outliers, result.unseen),
                                        .sliding = shares_of_sliding(mesh)});
  result.warnings = std::move(placed_.warnings);
  result.mesh = std::move(mesh);
  return result;
}

Result<FitResult> Fitting::among_allowed(std::vector<std::int32_t> lacking) {
  lacking_ = std::move(lacking);
  if (auto placed = place(); !placed) return fail(placed.error());
  const auto forces = [this](const Mesh& mesh, double share) {
    shape_.mesh = mesh;
    return steps_.force(mesh, placed_.placement, share);
  };
  const auto after_step = [this](double share) { return show(shape_.mesh.points, 0.1 + 0.4 * share); };
  const auto found = fit_allowed(*options_.allowed, template_.topology, placed_.placement, forces, after_step);
  if (!found) return fail(found.error());
  shape_.mesh.points = found->points;
  shape_.placement = found->placement;
  shape_.rest = found->shape;
  shape_.place_anew();
  if (options_.partial) lacking_ = either(lacking_, beyond_noise({template_.topology, found->points}));
  const double beyond = options_.allowed->beyond;
  if (beyond > 0) {
    if (auto done = steps_.anneal_to_target(shape_, from_placement); !done) return fail(done.error());
    if (auto done = steps_.settle(shape_); !done) return fail(done.error());
  }
  if (beyond < 1) {
    shape_.mesh.points = found->points + beyond * (shape_.mesh.points - found->points);
    shape_.place_anew();
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
  target_.set_reach_mm(size_mm);
  const TargetPull pull = target_.nearest(mesh);
  std::vector<double> off_mm;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    if (pull.weights[i] > 0) off_mm.push_back((pull.targets.row(i) - mesh.points.row(i)).norm());
  if (off_mm.empty()) return target_.missing(mesh);
  target_.set_reach_mm(
      std::max(SurfaceTarget::closest_reach * size_mm, noise_counts / normal_median * quantile(off_mm, 0.5)));
  return target_.missing(mesh);
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
      for (const std::int32_t j : template_.topology->one_ring(i)) sum += before[j], ++count;
      kept[i] = std::max(all[i], sum / count);
    }
  }
  shape_.mesh.points += kept.asDiagonal() * (likely - shape_.mesh.points);
  shape_.place_anew();
}

Result<void> Fitting::place() {
  auto placed = place_template(template_, target_.boundary(), options_);
  if (!placed) return fail(placed.error());
  placed_ = std::move(*placed);
  shape_.placement = placed_.placement;
  steps_.trust(placed_.trust);
  if (options_.allowed) {
    shape_.mesh = {template_.topology, placed_.points};
    return show(placed_.points, 0.1);
  }
  // Vertices stick where they are nearest, so a rim that lies far off has to be near before they are drawn.
  const KnownMatches known = whole() ? with_rims(placed_.landmarks, {template_.topology, placed_.points}, RimsLie::near,
                                                 placed_.points, target_)
                                     : placed_.landmarks;
  shape_.mesh = {template_.topology,
                 warp_to_boundary(template_.topology, placed_.points, known, whole() ? round_ : 0, target_)};
  if (!shape_.mesh.points.allFinite() || !(placed_.placement.scale > 0))
    return fail("", "the template cannot be placed on the surface: one of them is flat or has no size; check both");
  return show(shape_.mesh.points, 0);
}

FitContext Fitting::context() {
  return {.the_template = template_,
          .target = target_,
          .steps = steps_,
          .placed = placed_,
          .roundness = round_,
          .parts = parts_};
}

Result<void> Fitting::adapt_to_parts() {
  PartialWays ways(context());
  parts_ = {0, 2 + about_right_.size()};
  const auto next = [this](Result<void> done) {
    ++parts_.done;
    return done;
  };
  if (auto done = next(ways.from_placement(shape_.mesh.points, placed_.placement)); !done) return done;
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
  shape_.rest = template_.points;
  if (lacking_.empty()) return {};
  keep_where_lacking(best.way.shape.mesh.points);
  untangle(shape_.mesh, shape_.placed, shape_.factors);
  return {};
}

Result<void> Fitting::adapt_to_whole() {
  WholeWays ways(context());
  const bool match = (whole() || matches_beyond_cuts_) && !options_.rough;
  if (auto done = ways.go(shape_.mesh.points, match); !done) return done;
  auto kept = ways.kept();
  if (!kept) return fail(kept.error());
  shape_ = std::move(*kept);
  ways_ = ways.gone();
  smooth_ = ways.smooth();
  return {};
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
  options_.progress->report((static_cast<double>(parts_.done) + done) / static_cast<double>(parts_.all));
  return options_.progress->cancelled() ? Result<void>(fail("", "the fit was cancelled")) : Result<void>{};
}

}  // namespace homolog
