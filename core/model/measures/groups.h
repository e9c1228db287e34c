#pragma once

#include <vector>

#include "core/mesh/topology.h"
#include "core/model/shape_model.h"

namespace homolog {

/// Mean of the shapes `to` minus mean of the shapes `from` (columns of the components), n×3, mm. Neither may be empty.
Points group_difference_mm(const PrincipalComponents& components, const std::vector<Eigen::Index>& from,
                           const std::vector<Eigen::Index>& to);

/// How far an offset (n×3, mm) leads along the normals of a shape, outwards positive; its length where the shape is
/// points alone.
VertexScalars outward_mm(const Mesh& shape, const Points& offset_mm);

}  // namespace homolog
