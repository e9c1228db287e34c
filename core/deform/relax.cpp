#include "core/deform/falloff.h"
#include "core/deform/gesture.h"
#include "core/deform/local_rotations.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

Points relaxation_offset(const Topology& topology, const ShapeSolver& solver, const Points& reference,
                         const Points& points) {
  Points target = points + rotated_reference_force(topology, solver.weights(), reference,
                                                   local_rotations(topology, reference, points));
  if (solver.hold().size() > 0) target += solver.hold().asDiagonal() * points;
  return solver.solve(target) - points;
}

StrokeOutcome relax(const StrokeStart& start, const ShapeSolver& solver, const Stroke& stroke) {
  const Topology& topology = *start.topology;
  const Points& from = *start.points;
  const FoldGuard guard(topology, *start.placed, from);
  const auto nearest = nearest_on_surface(topology, from, stroke.at);
  VertexScalars brush = stroke.strength * gaussian_falloff(topology, from, nearest.at, stroke.sigma_mm,
                                                           mean_edge_mm(topology, from), stroke.through_space);
  if (start.confirmed) brush = brush.cwiseProduct((1 - start.confirmed->array()).matrix());

  StrokeOutcome outcome;
  outcome.solves = 1;
  outcome.on = nearest.position;
  const Points offset = brush.asDiagonal() * relaxation_offset(topology, solver, *start.reference, from);
  outcome.response = std::make_shared<const VertexScalars>(std::move(brush));
  const auto at = [&](double step) { return Points(from + step * offset); };
  const double step = guard.accepted_step(1, at);
  outcome.points = at(step);
  outcome.stopped_by_guard = step < 1;
  outcome.moved_mm = (outcome.points - from).rowwise().norm().maxCoeff();
  return outcome;
}

}  // namespace homolog
