#pragma once

#include <memory>
#include <utility>

#include "core/case/document.h"

namespace homolog {

/// Notes how far an edit has decided each vertex, 0 … 1.
inline void decide(Shape& shape, std::shared_ptr<const VertexScalars> share) {
  shape.decided = shape.decided ? std::make_shared<const VertexScalars>(shape.decided->cwiseMax(*share)) : share;
}

/// Notes what a stroke has carried: a snap holds it from then on.
inline void note_pull(Shape& shape, const VertexScalars& share) {
  VertexScalars carried = share.cwiseMax(0).cwiseMin(1);
  if (shape.pulled) carried = carried.cwiseMax(*shape.pulled).eval();
  shape.pulled = std::make_shared<const VertexScalars>(std::move(carried));
  ++shape.pulls;
}

/// Lets go of what was pulled.
inline void forget_pulls(Shape& shape) {
  shape.pulled.reset();
  shape.pulls = 0;
}

/// The shape without the model's help, after an edit that sets points: a vertex that the edit moved is where the edit
/// put it. All n×3, LPS mm.
inline Points unaided_after(const Points& unaided, const Points& from, const Points& to) {
  Points after = unaided;
  for (Eigen::Index i = 0; i < after.rows(); ++i)
    if (from.row(i) != to.row(i)) after.row(i) = to.row(i);
  return after;
}

}  // namespace homolog
