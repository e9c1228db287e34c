#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// How far each vertex of a fit may lie from where it belongs, as root mean square [mm]. Five things add up as
/// squares: a least doubt, how far the ways onto the boundary went apart, how much the shape had to be strained, how
/// few features tell where along the surface a vertex belongs, and for what is missing the way to what is there. Half
/// of what holds everywhere lies where vertices can slide [shares_of_sliding]; its mean square stays. The
/// scale was set on bones with experts' landmarks and on phantom kidneys (docs/correspondence.md). `spread_mm2`: of the
/// ways about the mesh, squared, n; where the organ looks mirrored, of the mirror image too. `strain`: see
/// strain_share. `roundness`: 0 where features or landmarks tell, 1 where nothing does. `missing`: the vertices of what
/// the target lacks or the scan does not show. `sliding`: n, of mean 1.
VertexScalars fit_doubt_mm(const Mesh& mesh, const VertexScalars& spread_mm2, double strain, double roundness,
                           const std::vector<std::int32_t>& missing, const VertexScalars& sliding);

}  // namespace homolog
