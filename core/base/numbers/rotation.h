#pragma once

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The proper rotation R nearest to a 3×3 matrix: the one with the largest tr(Rᵀ a) [Kabsch 1978; Umeyama 1991]. For
/// a = Σ toᵀ from over centred points it is the one that carries `from` nearest to `to`.
Mat3 nearest_rotation(const Mat3& a);

}  // namespace homolog
