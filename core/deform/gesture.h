#pragma once

#include <memory>
#include <optional>

#include "core/base/result.h"
#include "core/deform/fold_guard.h"
#include "core/deform/stroke.h"
#include "core/deform/surface_walk.h"
#include "core/solve/shape_solver.h"

namespace homolog {

struct StrokeKind;

/// The start of a stroke and the settings it runs under. All n×3 in LPS mm.
struct StrokeStart {
  std::shared_ptr<const Topology> topology;
  std::shared_ptr<const Points> placed;     ///< the template as placed, not warped: what "turned" is measured against
  std::shared_ptr<const Points> reference;  ///< R
  std::shared_ptr<const Points> points;     ///< P⁰
  std::shared_ptr<const VertexScalars> stiffness;  ///< factor_i; w_i = stiffness_base × factor_i
  double stiffness_base = 0;                       ///< above 0
  std::shared_ptr<const VertexScalars> confirmed;  ///< 0 free … 1 held; null for all free
  Scheme scheme = Scheme::anchored;
  int paper_events = 1;
  double even_spacing = 0;
};

struct StrokeOutcome {
  Points points;
  bool stopped_by_guard = false;
  double moved_mm = 0;                            ///< the grabbed point's way
  Vec3 on = Vec3::Zero();                         ///< the place on the gesture-start surface that the gesture holds
  std::shared_ptr<const VertexScalars> response;  ///< û (raw, paper: g)
  int solves = 0;
};

/// Whether an outcome is only shown or about to be kept. An outcome to keep is checked with the full definition of a
/// turned triangle.
enum class Pass { preview, commit };

/// One running drag [docs/method.md §2–3]. The response is solved for when the falloff changes; a frame in which only
/// the cursor moved costs one n×3 update.
class Gesture {
 public:
  /// `solver` is factorised for the start's stiffness and outlives the gesture.
  Gesture(const StrokeStart& start, const ShapeSolver& solver, Tool tool, const Vec3& at, bool through_space);
  Gesture(const Gesture&) = delete;
  Gesture& operator=(const Gesture&) = delete;

  /// The shape for a cursor at `stroke.to`. Errors: the grabbed place is confirmed.
  Result<StrokeOutcome> move(const Stroke& stroke, Pass pass);

  /// Whether `stroke` from `start` continues this gesture (same points, tool and place).
  bool continues(const StrokeStart& start, const Stroke& stroke) const;

 private:
  bool held(const SurfacePoint& at) const;
  void aim(const SurfacePoint& centre, double sigma_mm, Pass pass, StrokeOutcome& outcome);
  Points paper_points(const Vec3& d, double sigma_mm, StrokeOutcome& outcome) const;
  void slide(const Vec3& d, StrokeOutcome& outcome) const;
  void keep_evenly_spaced(const Vec3& d, StrokeOutcome& outcome) const;

  StrokeStart start_;
  const ShapeSolver& solver_;
  const StrokeKind& kind_;
  Vec3 at_;
  bool through_space_;
  double edge_mm_;
  SurfacePoint grabbed_;
  SurfacePoint free_;  ///< where the follower last was outside confirmed regions
  FoldGuard guard_;
  std::unique_ptr<SurfaceFollower> follower_;  ///< only of a kind that follows the cursor

  // The response in use and what it was solved for.
  std::shared_ptr<const VertexScalars> response_;
  SurfacePoint centre_;
  double sigma_mm_ = -1;
};

/// Relax: (3) solved with S = P and locally rotated reference, blended in by strength times the Gaussian falloff around
/// the surface point nearest to `stroke.at`. Never turns a triangle.
StrokeOutcome relax(const StrokeStart& start, const ShapeSolver& solver, const Stroke& stroke);

/// The places to which (3) would move the points with S = P and a reference that turns with the shape, minus P: C of
/// docs/method.md (Spacing), λ = 1.
Points relaxation_offset(const Topology& topology, const ShapeSolver& solver, const Points& reference,
                         const Points& points);

}  // namespace homolog
