#pragma once

#include <memory>

#include "core/case/document.h"

namespace homolog {

/// Notes how far an edit has decided each vertex, 0 … 1.
inline void decide(Shape& shape, std::shared_ptr<const VertexScalars> share) {
  shape.decided = shape.decided ? std::make_shared<const VertexScalars>(shape.decided->cwiseMax(*share)) : share;
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
