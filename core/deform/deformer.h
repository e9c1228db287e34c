#pragma once

#include <memory>

#include "core/deform/gesture.h"

namespace homolog {

/// Keeps what is worth keeping between strokes: the factorisation and the running gesture. It is a cache: the same
/// start and stroke give the same points with a fresh Deformer, except that a pull without `on` follows the
/// cursor positions seen so far.
class Deformer {
 public:
  /// Errors: a stiffness that cannot be factorised, a stroke that is not finite, a confirmed place.
  Result<StrokeOutcome> stroke(const StrokeStart& start, const Stroke& stroke, Pass pass);
  /// The next stroke begins anew: a pull without `on` follows the straight path.
  void end_gesture() { gesture_.reset(); }

 private:
  Result<void> prepare(const StrokeStart& start);

  std::unique_ptr<ShapeSolver> solver_;
  std::shared_ptr<const VertexScalars> stiffness_, confirmed_;  ///< what *solver_ is factorised for
  double stiffness_base_ = 0;
  std::unique_ptr<Gesture> gesture_;  ///< refers to *solver_
};

}  // namespace homolog
