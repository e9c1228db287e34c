#pragma once

#include <memory>

#include "core/deform/gesture.h"

namespace homolog {

/// Keeps the factorisation and the running gesture between strokes. It is only a cache: a fresh Deformer gives the same
/// points for the same start and stroke. One exception: a pull without `on` follows the cursor positions seen so far.
class Deformer {
 public:
  /// Errors: those of `prepare`, a point of the start or a stroke that is not finite, a confirmed place.
  Result<StrokeOutcome> stroke(const StrokeStart& start, const Stroke& stroke, Pass pass);
  /// Factorises ahead, so that the next stroke from `start` begins at once. Errors: a start without a topology, points
  /// or a stiffness, or with another number of them than the topology has; a stiffness that cannot be factorised.
  Result<void> prepare(const StrokeStart& start);
  /// The next stroke begins anew: a pull without `on` follows the straight path.
  void end_gesture() { gesture_.reset(); }

 private:
  std::unique_ptr<ShapeSolver> solver_;
  std::shared_ptr<const VertexScalars> stiffness_, confirmed_;  ///< the values that *solver_ is factorised for
  double stiffness_base_ = 0;
  std::unique_ptr<Gesture> gesture_;  ///< refers to *solver_
};

}  // namespace homolog
