#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// How far each vertex of a fit may lie from where it belongs, as root mean square [mm]. Three things add up as
/// squares: how far the ways onto the boundary went apart, how much the shape had to be strained, and for what is
/// missing the way to what is there. The scale was set on bones with experts' landmarks (docs/correspondence.md).
/// `spread_mm2`: of the ways about the mesh, squared, n. `strain`: see strain_share. `outliers`: the vertices of what
/// is missing.
VertexScalars fit_doubt_mm(const Mesh& mesh, const VertexScalars& spread_mm2, double strain,
                           const std::vector<std::int32_t>& outliers);

}  // namespace homolog
