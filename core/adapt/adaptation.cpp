#include "core/adapt/adaptation.h"

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

/// Of the root of the boundary's area: how much farther off it a way may end, and as what a vertex counts at most.
constexpr double stays_off_share = 0.0015, most_counted_share = 0.03;
constexpr int settling_steps = 3, sliding_steps = 2;
constexpr double widest_reach = 0.1;  ///< of the mesh's diagonal: how far a partial fit looks for counterparts at first
constexpr double easing_edges = 1;    ///< mean edges: folds of the template finer than about this are eased

}  // namespace

Adaptation::Adaptation(const Template& the_template, const Boundary& boundary, BoundarySearch& search,
                       const FitOptions& options, Show show)
    : reference_(the_template),
      boundary_(boundary),
      search_(search),
      options_(options),
      size_mm_(std::sqrt(surface_area_mm2(boundary.surface))),
      show_(std::move(show)),
      solver_(the_template.topology),
      factors_(the_template.stiffness / the_template.stiffness.mean()) {}

Result<Adapted> Adaptation::adapt(const Points& points, const Similarity& placement, const Points& reference,
                                  const Annealing& annealing) {
  auto smooth = eased(reference);
  if (!smooth) return fail(smooth.error());
  Adapting shape{{reference_.topology, points}, std::move(*smooth), placement, {}, factors_, {}};
  shape.refit();
  if (auto done = anneal_to_boundary(shape, annealing); !done) return fail(done.error());
  shape.rest = reference;
  if (auto done = settle(shape); !done) return fail(done.error());
  const double strain_left = strain(shape), left_mm2 = off_mm2(shape.mesh);
  return Adapted{std::move(shape), strain_left, left_mm2};
}

Result<void> Adaptation::anneal_to_boundary(Adapting& shape, const Annealing& annealing) {
  return anneal(
      shape, solver_, annealing, [&](const Mesh& mesh, double share) { return force(mesh, shape.placement, share); },
      [&](double share) { return show_(shape.mesh.points, 0.1 + 0.7 * share); });
}

Result<void> Adaptation::settle(Adapting& shape) {
  Mesh& mesh = shape.mesh;
  if (auto ready = solver_.factorise(shape.factors); !ready) return ready;
  for (int step = 0; step < settling_steps; ++step) {
    shape.refit();
    const FoldGuard guard(*mesh.topology, shape.placed, mesh.points);
    const Points offset = tangential(mesh, relaxation_offset(*mesh.topology, solver_, shape.placed, mesh.points));
    const auto slid = [&](double share) { return Points(mesh.points + share * offset); };
    mesh.points = slid(guard.accepted_step(1, slid));
    mesh.points = search_.nearest(mesh).targets;
    if (auto shown = show_(mesh.points, 0.8 + 0.1 * step / settling_steps); !shown) return shown;
  }
  shape.refit();
  // A match that is its own reference may have turned a triangle of the template. A model's shape has not.
  untangle(mesh, options_.allowed ? shape.placed : template_placed(shape), shape.factors);
  return show_(mesh.points, 0.95);
}

Result<void> Adaptation::settle_as_it_is(Adapting& shape) {
  shape.rest = unplaced(shape.mesh.points);
  return settle(shape);
}

Result<void> Adaptation::slide_to_facing(Adapting& shape, double share) {
  const Adapting before = shape;
  const double most_mm = most_off_mm(off_mm2(before.mesh)),
               edge_mm = mean_edge_mm(*reference_.topology, shape.mesh.points),
               diagonal_mm = bounds_of(shape.mesh.points).diagonal().norm();
  const FacingSearch facing(boundary_.surface, reference_.points.rows());
  const auto forces = [&](const Mesh& mesh, double) {
    return with_landmarks(facing.pull({reference_.topology, template_placed(shape)}, mesh), mesh);
  };
  const Annealing equally_stiff{.steps = sliding_steps,
                                .softest_edges = facing.stiffness_mm() / edge_mm,
                                .stiffest_share = facing.stiffness_mm() / diagonal_mm};
  if (auto done = anneal(shape, solver_, equally_stiff, forces); !done) return done;
  shape.mesh.points = share * shape.mesh.points + (1 - share) * before.mesh.points;
  if (auto done = settle_as_it_is(shape); !done) return done;
  if (!(std::sqrt(off_mm2(shape.mesh)) <= most_mm)) shape = before;
  return {};
}

Force Adaptation::force(const Mesh& mesh, const Similarity& placement, double share) {
  if (options_.partial) {
    const double size_mm = bounds_of(placement.apply(reference_.points)).diagonal().norm();
    search_.set_reach_mm(widest_reach * std::pow(closest_reach / widest_reach, share) * size_mm);
  }
  return with_landmarks(search_.pull(mesh), mesh);
}

Force Adaptation::with_landmarks(BoundaryPull pull, const Mesh& mesh) const {
  pull_landmarks(reference_, options_.landmarks, trust_, mesh, pull);
  const VertexScalars weights = pull.weights.cwiseMax(least_weight) / least_weight;
  return {weights, weights.asDiagonal() * pull.targets};
}

double Adaptation::off_mm2(const Mesh& mesh) {
  const BoundaryPull left = search_.pull(mesh);
  const double most_mm = most_counted_share * size_mm_;
  const VertexScalars away_mm2 = (left.targets - mesh.points).rowwise().squaredNorm().cwiseMin(most_mm * most_mm);
  return left.weights.dot(away_mm2) / static_cast<double>(mesh.points.rows());
}

double Adaptation::strain(const Adapting& shape) const {
  return strain_share(*reference_.topology, template_placed(shape), shape.mesh.points);
}

double Adaptation::most_off_mm(double left_mm2) const {
  return std::sqrt(left_mm2) + stays_off_share * size_mm_;
}

Points Adaptation::unplaced(const Points& shape) const {
  return nearest_similarity(shape, reference_.points, {}).apply(shape);
}

Points Adaptation::template_placed(const Adapting& shape) const {
  return nearest_similarity(reference_.points, shape.mesh.points, shape.placement).apply(reference_.points);
}

/// Smooths the reference that the annealing keeps to. A deep fold that the case does not have would stay behind:
/// its walls face each other, and neither finds the boundary. The folds that a case has come from its boundary.
Result<Points> Adaptation::eased(const Points& reference) {
  const double edge_mm = mean_edge_mm(*reference_.topology, reference);
  const double stiffness = stiffness_from_length(easing_edges * edge_mm, edge_mm);
  const VertexScalars even = VertexScalars::Constant(reference.rows(), stiffness);
  if (auto ready = solver_.factorise(even); !ready) return fail(ready.error());
  const Points smooth = solver_.solve(reference);
  return nearest_similarity(smooth, reference, {}).apply(smooth);
}

}  // namespace homolog
