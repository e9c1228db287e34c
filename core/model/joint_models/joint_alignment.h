#pragma once

#include <vector>

#include "core/model/joint_models/structure_parts.h"

namespace homolog {

/// The similarity that carries `from` nearest to `to` (both n×3); with `rigid` or `none` its scale is 1.
Similarity pose_onto(const Points& from, const Points& to, Alignment alignment);

/// Aligns shapes that are made of several structures, in place, and says where each structure lies in them.
///
/// Together: `align` of the whole shapes, so that where the structures lie to each other is part of the shapes. With
/// `each`, the structures of the shapes so aligned are aligned again, each on its own, and put to the structure's mean
/// place; the poses that this takes out are given back. Throws std::invalid_argument for `each` without an
/// alignment.
StructurePoses align_structures(ShapeMatrix& shapes, const std::vector<StructurePart>& parts, Alignment alignment,
                                bool each);

}  // namespace homolog
