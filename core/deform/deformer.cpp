#include "core/deform/deformer.h"

#include <cmath>

namespace homolog {

namespace {

bool usable(const Stroke& stroke) {
  return stroke.at.allFinite() && stroke.to.allFinite() && std::isfinite(stroke.sigma_mm) && stroke.sigma_mm > 0 &&
         (!stroke.on || stroke.on->allFinite()) && stroke.strength >= 0 && stroke.strength <= 1;
}

}  // namespace

Result<void> Deformer::prepare(const StrokeStart& start) {
  const bool new_topology = !solver_ || solver_->topology() != start.topology;
  if (!new_topology && stiffness_ == start.stiffness && stiffness_base_ == start.stiffness_base &&
      confirmed_ == start.confirmed) {
    return {};
  }
  gesture_.reset();
  stiffness_.reset();  // nothing is factorised until the line below succeeds
  if (new_topology) solver_ = std::make_unique<ShapeSolver>(start.topology);
  const bool held = start.confirmed && start.confirmed->any();
  const VertexScalars w = start.stiffness_base * *start.stiffness;
  const VertexScalars hold = held ? firm_hold(*start.topology, w, *start.confirmed) : VertexScalars();
  if (auto done = solver_->factorise(w, hold); !done) return done;
  stiffness_ = start.stiffness;
  stiffness_base_ = start.stiffness_base;
  confirmed_ = start.confirmed;
  return {};
}

Result<StrokeOutcome> Deformer::stroke(const StrokeStart& start, const Stroke& stroke, Pass pass) {
  if (!usable(stroke)) return fail("stroke", "has a number that is not finite, or a σ or strength out of range");
  if (auto ready = prepare(start); !ready) return fail(ready.error());
  if (stroke.tool == Tool::relax) return relax(start, *solver_, stroke);
  if (!gesture_ || !gesture_->continues(start, stroke)) {
    gesture_ = std::make_unique<Gesture>(start, *solver_, stroke.tool, stroke.at, stroke.through_space);
  }
  return gesture_->move(stroke, pass);
}

}  // namespace homolog
