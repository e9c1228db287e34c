#include "core/deform/deformer.h"

#include <cmath>

#include "core/deform/stroke_kinds.h"
#include "core/mesh/check_mesh.h"

namespace homolog {

namespace {

bool usable(const Stroke& stroke) {
  return stroke.at.allFinite() && stroke.to.allFinite() && std::isfinite(stroke.sigma_mm) && stroke.sigma_mm > 0 &&
         (!stroke.on || stroke.on->allFinite()) && stroke.strength >= 0 && stroke.strength <= 1;
}

/// Numbers alone, since a drag asks in every frame.
Result<void> check_counts(const StrokeStart& start) {
  if (!start.topology || !start.placed || !start.reference || !start.points || !start.stiffness)
    return fail("", "the start of a stroke lacks a topology, points or a stiffness; take it from a case");
  const Eigen::Index vertices = start.topology->vertices();
  for (const auto& points : {start.placed.get(), start.reference.get(), start.points.get()})
    if (auto counted = check_count(points->rows(), vertices, "the start of a stroke"); !counted) return counted;
  if (auto counted = check_count(start.stiffness->size(), vertices, "the stiffness"); !counted) return counted;
  return start.confirmed ? check_count(start.confirmed->size(), vertices, "what is confirmed") : Result<void>{};
}

/// Once a gesture, and at each dab.
Result<void> check_points_of(const StrokeStart& start) {
  const Eigen::Index vertices = start.topology->vertices();
  if (auto sound = check_points(*start.placed, vertices, "the template as placed"); !sound) return sound;
  if (auto sound = check_points(*start.reference, vertices, "the reference"); !sound) return sound;
  return check_points(*start.points, vertices, "the mesh");
}

}  // namespace

Result<void> Deformer::prepare(const StrokeStart& start) {
  if (auto counted = check_counts(start); !counted) return counted;
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
  const StrokeKind& kind = kind_of_stroke(stroke.tool);
  const bool goes_on = !kind.is_dab() && gesture_ && gesture_->continues(start, stroke);
  if (!goes_on)
    if (auto sound = check_points_of(start); !sound) return fail(sound.error());
  if (kind.is_dab()) return kind.dab(start, *solver_, stroke);
  if (!goes_on) {
    gesture_ = std::make_unique<Gesture>(start, *solver_, stroke.tool, stroke.at, stroke.through_space);
  }
  return gesture_->move(stroke, pass);
}

}  // namespace homolog
