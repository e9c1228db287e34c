#include "core/deform/gesture.h"
#include "core/deform/local_rotations.h"

namespace homolog {

Points relaxation_offset(const Topology& topology, const ShapeSolver& solver, const Points& reference,
                         const Points& points) {
  Points target = points + rotated_reference_force(topology, solver.weights(), reference,
                                                   fit_local_rotations(topology, reference, points));
  if (solver.hold().size() > 0) target += solver.hold().asDiagonal() * points;
  return solver.solve(target) - points;
}

StrokeOutcome relax(const StrokeStart& start, const ShapeSolver& solver, const Stroke& stroke) {
  const Topology& topology = *start.topology;
  const Points& from = *start.points;
  const FoldGuard guard(topology, *start.placed, from);
  VertexScalars brush = (from.rowwise() - stroke.at.transpose()).rowwise().squaredNorm();
  brush = stroke.strength * (-brush.array() / (2 * stroke.sigma_mm * stroke.sigma_mm)).exp();
  if (start.confirmed) brush = brush.cwiseProduct((1 - start.confirmed->array()).matrix());

  StrokeOutcome outcome;
  outcome.solves = 1;
  outcome.on = stroke.at;
  const Points offset = brush.asDiagonal() * relaxation_offset(topology, solver, *start.reference, from);
  outcome.response = std::make_shared<const VertexScalars>(std::move(brush));
  double step = 1;
  outcome.points = from + offset;
  while (!guard.accepts(outcome.points) && step > 1e-3) {
    step /= 2;
    outcome.points = from + step * offset;
  }
  if (step <= 1e-3) outcome.points = from;
  outcome.stopped_by_guard = step < 1;
  outcome.moved_mm = (outcome.points - from).rowwise().norm().maxCoeff();
  return outcome;
}

}  // namespace homolog
