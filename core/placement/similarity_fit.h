#pragma once

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The similarity (proper rotation, uniform scale) that carries `from` to `to` (both n×3, row by row) in the
/// least-squares sense [Umeyama 1991]. Starting from `current`: one point only translates; two or collinear points also
/// scale and turn by the smallest rotation, so that the spin about their line stays; no point leaves it as it is.
/// Throws std::invalid_argument where `from` and `to` are not as many.
Similarity nearest_similarity(const Points& from, const Points& to, const Similarity& current);

}  // namespace homolog
