#include "core/deform/gesture.h"

#include <algorithm>
#include <cmath>

#include "core/deform/falloff.h"
#include "core/deform/stroke_kinds.h"
#include "core/deform/tangential.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double same_place_mm = 1e-12;

double value_at(const Topology& topology, const VertexScalars& values, const SurfacePoint& at) {
  return at.interpolate(topology, values)[0];
}

}  // namespace

Gesture::Gesture(const StrokeStart& start, const ShapeSolver& solver, Tool tool, const Vec3& at, bool through_space)
    : start_(start),
      solver_(solver),
      kind_(kind_of_stroke(tool)),
      at_(at),
      through_space_(through_space),
      edge_mm_(mean_edge_mm(*start.topology, *start.points)),
      grabbed_(nearest_on_surface(*start.topology, *start.points, at).at),
      free_(grabbed_),
      guard_(*start_.topology, *start_.placed, *start_.points) {
  if (kind_.follows_cursor) {
    const Vec3 from = grabbed_.interpolate(*start_.topology, *start_.points).transpose();
    follower_ = std::make_unique<SurfaceFollower>(*start_.topology, *start_.points, grabbed_, from);
  }
}

bool Gesture::continues(const StrokeStart& start, const Stroke& stroke) const {
  return start.topology == start_.topology && start.points == start_.points && start.reference == start_.reference &&
         start.confirmed == start_.confirmed && start.scheme == start_.scheme &&
         start.paper_events == start_.paper_events && start.even_spacing == start_.even_spacing &&
         start.stiffness == start_.stiffness && start.stiffness_base == start_.stiffness_base &&
         stroke.tool == kind_.tool && stroke.at == at_ && stroke.through_space == through_space_;
}

void Gesture::aim(const SurfacePoint& centre, double sigma_mm, Pass pass, StrokeOutcome& outcome) {
  // What is kept does not depend, not even in the last bit, on what was previewed.
  const double tolerance = pass == Pass::commit ? 0 : same_place_mm;
  const bool same = response_ != nullptr && sigma_mm == sigma_mm_ && centre.face == centre_.face &&
                    (centre.weights - centre_.weights).norm() <= tolerance;
  if (same) return;
  response_.reset();  // nothing is known of either place if memory runs out below
  const VertexScalars g =
      gaussian_falloff(*start_.topology, *start_.points, centre, sigma_mm, edge_mm_, through_space_);
  if (start_.scheme == Scheme::anchored || kind_.along_surface) {
    VertexScalars u = solver_.solve(g);
    ++outcome.solves;
    u /= value_at(*start_.topology, u, centre);
    if (start_.confirmed) u = (start_.confirmed->array() >= 1).select(0, u);
    auto response = std::make_shared<const VertexScalars>(std::move(u));
    guard_.set_response(*response);
    response_ = std::move(response);
  } else {
    response_ = std::make_shared<const VertexScalars>(g);
  }
  centre_ = centre;
  sigma_mm_ = sigma_mm;
}

bool Gesture::held(const SurfacePoint& at) const {
  return start_.confirmed && value_at(*start_.topology, *start_.confirmed, at) >= 0.5;
}

Result<StrokeOutcome> Gesture::move(const Stroke& stroke, Pass pass) {
  StrokeOutcome outcome;
  SurfacePoint centre = grabbed_;
  if (kind_.follows_cursor) {
    if (stroke.on) {
      centre = nearest_on_surface(*start_.topology, *start_.points, *stroke.on).at;
    } else {
      follower_->move_to(stroke.to, edge_mm_);
      // A pull that comes to a confirmed place stays where it was before, as at a rim.
      if (!held(follower_->at())) free_ = follower_->at();
      centre = free_;
    }
  }
  if (held(centre)) {
    return fail("",
                "This place is held, by a placed landmark or by Confirm; release the landmark (Place) or paint with "
                "Free to move it.");
  }
  aim(centre, stroke.sigma_mm, pass, outcome);
  const Vec3 position = centre.interpolate(*start_.topology, *start_.points).transpose();
  const Vec3 d = stroke.to - position;
  outcome.on = position;
  outcome.response = response_;

  if (kind_.along_surface) {
    slide(d, outcome);
  } else if (start_.scheme == Scheme::raw) {
    outcome.points = *start_.points + *response_ * d.transpose();
  } else if (start_.scheme == Scheme::paper) {
    outcome.points = paper_points(d, stroke.sigma_mm, outcome);
  } else {
    const auto at = [&](double step) { return Points(*start_.points + *response_ * (step * d).transpose()); };
    double step = guard_.largest_step(d);
    // The closed form uses the rotations at the start. What is kept must also pass with the rotations at the end.
    if (pass == Pass::commit) step = guard_.accepted_step(step, at);
    outcome.points = at(step);
    outcome.stopped_by_guard = step < 1;
    if (start_.even_spacing > 0) keep_evenly_spaced(d, outcome);
  }
  if (start_.confirmed) {
    for (Eigen::Index i = 0; i < outcome.points.rows(); ++i) {
      if ((*start_.confirmed)[i] >= 1) outcome.points.row(i) = start_.points->row(i);
    }
  }
  outcome.moved_mm = (centre.interpolate(*start_.topology, outcome.points).transpose() - position).norm();
  return outcome;
}

Points Gesture::paper_points(const Vec3& d, double sigma_mm, StrokeOutcome& outcome) const {
  // Read literally: every mouse event takes the current points as targets, pushed by the Gaussian, and solves (3)
  // [Erdt 2009, §2.2]; in displacements from the reference, M (P − R) = S − R.
  const Points& r = *start_.reference;
  Points p = *start_.points;
  for (int event = 0; event < start_.paper_events; ++event) {
    const VertexScalars g = gaussian_falloff(*start_.topology, p, centre_, sigma_mm, edge_mm_, through_space_);
    p += g * (d / start_.paper_events).transpose();
    Points b = p - r;
    if (solver_.hold().size() > 0) b += solver_.hold().asDiagonal() * (*start_.points - r);
    p = r + solver_.solve(b);
    ++outcome.solves;
  }
  return p;
}

void Gesture::slide(const Vec3& d, StrokeOutcome& outcome) const {
  const Mesh from{start_.topology, *start_.points};
  const Points along = tangential(from, *response_ * d.transpose());
  const auto at = [&](double step) { return slid_along_surface(from, step * along); };
  const double step = guard_.accepted_step(1, at);
  outcome.stopped_by_guard = step < 1;
  outcome.points = at(step);
}

void Gesture::keep_evenly_spaced(const Vec3& d, StrokeOutcome& outcome) const {
  const Topology& topology = *start_.topology;
  Points offset = tangential({start_.topology, outcome.points},
                             relaxation_offset(topology, solver_, *start_.reference, outcome.points));
  ++outcome.solves;
  // Nothing far away moves, and a click moves nothing.
  const double reach = start_.even_spacing * std::min(1.0, d.norm() / edge_mm_);
  offset = (reach * response_->array()).matrix().asDiagonal() * offset;
  const Points unspaced = outcome.points;
  const auto at = [&](double step) { return Points(unspaced + step * offset); };
  outcome.points = at(guard_.accepted_step(1, at));
}

}  // namespace homolog
