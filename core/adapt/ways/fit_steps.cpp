#include "core/adapt/ways/fit_steps.h"

#include <cmath>

#include "core/adapt/boundary/landmark_pull.h"
#include "core/adapt/match/facing_search.h"
#include "core/adapt/untangle.h"
#include "core/deform/fold_guard.h"
#include "core/deform/gesture.h"
#include "core/deform/local_rotations.h"
#include "core/deform/tangential.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr double stays_off_share = 0.0015;  ///< share of the target's size: how much farther off it a way may end
constexpr int settling_steps = 3, sliding_steps = 2;
constexpr double easing_edges = 1;  ///< mean edges: folds of the template finer than about this are eased

}  // namespace

FitSteps::FitSteps(const Template& the_template, Target& target, const FitOptions& options, Show show)
    : template_(the_template),
      target_(target),
      options_(options),
      show_(std::move(show)),
      solver_(the_template.topology),
      factors_(the_template.stiffness / the_template.stiffness.mean()) {}

Result<Adapted> FitSteps::adapt(const Points& points, const Similarity& placement, const Points& reference,
                                const Annealing& annealing) {
  auto smooth = eased(reference);
  if (!smooth) return fail(smooth.error());
  Adapting shape{
      .mesh = {template_.topology, points}, .rest = std::move(*smooth), .placement = placement, .factors = factors_};
  shape.place_anew();
  if (auto done = anneal_to_target(shape, annealing); !done) return fail(done.error());
  shape.rest = reference;
  if (auto done = settle(shape); !done) return fail(done.error());
  const double strain_left = strain(shape), left_mm2 = target_.off_mm2(shape.mesh);
  return Adapted{std::move(shape), strain_left, left_mm2};
}

Result<void> FitSteps::anneal_to_target(Adapting& shape, const Annealing& annealing) {
  return anneal(
      shape, solver_, annealing, [&](const Mesh& mesh, double share) { return force(mesh, shape.placement, share); },
      [&](double share) { return show_(shape.mesh.points, 0.1 + 0.7 * share); });
}

Result<void> FitSteps::settle(Adapting& shape) {
  Mesh& mesh = shape.mesh;
  if (auto ready = solver_.factorise(shape.factors); !ready) return ready;
  for (int step = 0; step < settling_steps; ++step) {
    shape.place_anew();
    const FoldGuard guard(*mesh.topology, shape.placed, mesh.points);
    const Points offset = tangential(mesh, relaxation_offset(*mesh.topology, solver_, shape.placed, mesh.points));
    const auto slid = [&](double share) { return Points(mesh.points + share * offset); };
    mesh.points = slid(guard.accepted_step(1, slid));
    mesh.points = target_.nearest(mesh).targets;
    if (auto shown = show_(mesh.points, 0.8 + 0.1 * step / settling_steps); !shown) return shown;
  }
  shape.place_anew();
  // A match that is its own reference may have turned a triangle of the template. A model's shape has not.
  untangle(mesh, options_.allowed ? shape.placed : template_placed(shape), shape.factors);
  return show_(mesh.points, 0.95);
}

Result<void> FitSteps::settle_as_it_is(Adapting& shape) {
  shape.rest = unplaced(shape.mesh.points);
  return settle(shape);
}

Result<void> FitSteps::slide_to_facing(Adapting& shape, const Mesh& surface, double share) {
  const Adapting before = shape;
  const double most_mm = most_off_mm(target_.off_mm2(before.mesh)),
               edge_mm = mean_edge_mm(*template_.topology, shape.mesh.points),
               diagonal_mm = bounds_of(shape.mesh.points).diagonal().norm();
  const FacingSearch facing(surface, template_.points.rows());
  const auto forces = [&](const Mesh& mesh, double) {
    return with_landmarks(facing.pull({template_.topology, template_placed(shape)}, mesh), mesh);
  };
  const Annealing equally_stiff{.steps = sliding_steps,
                                .softest_edges = facing.stiffness_mm() / edge_mm,
                                .stiffest_share = facing.stiffness_mm() / diagonal_mm};
  if (auto done = anneal(shape, solver_, equally_stiff, forces); !done) return done;
  shape.mesh.points = share * shape.mesh.points + (1 - share) * before.mesh.points;
  if (auto done = settle_as_it_is(shape); !done) return done;
  if (!(std::sqrt(target_.off_mm2(shape.mesh)) <= most_mm)) shape = before;
  return {};
}

Force FitSteps::force(const Mesh& mesh, const Similarity& placement, double share) {
  if (options_.partial) target_.may_lack_parts(bounds_of(placement.apply(template_.points)).diagonal().norm());
  return with_landmarks(target_.pull(mesh, share), mesh);
}

Force FitSteps::with_landmarks(TargetPull pull, const Mesh& mesh) const {
  pull_landmarks(template_, options_.landmarks, trust_, mesh, pull);
  return force_of(pull);
}

double FitSteps::strain(const Adapting& shape) const {
  return strain_share(*template_.topology, template_placed(shape), shape.mesh.points);
}

double FitSteps::most_off_mm(double left_mm2) const {
  return std::sqrt(left_mm2) + stays_off_share * target_.size_mm();
}

Points FitSteps::unplaced(const Points& shape) const {
  return nearest_similarity(shape, template_.points, {}).apply(shape);
}

Points FitSteps::template_placed(const Adapting& shape) const {
  return nearest_similarity(template_.points, shape.mesh.points, shape.placement).apply(template_.points);
}

/// Smooths the reference that the annealing keeps to. A deep fold that the case does not have would stay behind:
/// its walls face each other, and neither finds the boundary. The folds that a case has come from its boundary.
Result<Points> FitSteps::eased(const Points& reference) {
  const double edge_mm = mean_edge_mm(*template_.topology, reference);
  const double stiffness = stiffness_from_length(easing_edges * edge_mm, edge_mm);
  const VertexScalars even = VertexScalars::Constant(reference.rows(), stiffness);
  if (auto ready = solver_.factorise(even); !ready) return fail(ready.error());
  const Points smooth = solver_.solve(reference);
  return nearest_similarity(smooth, reference, {}).apply(smooth);
}

}  // namespace homolog
