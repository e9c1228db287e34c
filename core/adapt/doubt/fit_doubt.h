#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// What a fit gives reason to doubt.
struct ReasonsForDoubt {
  VertexScalars spread_mm2;  ///< n: of the ways about the mesh, squared; where the organ looks mirrored, of that too
  double strain = 0;         ///< how much the shape had to be strained [strain_share]
  double roundness = 0;      ///< 0 where features or landmarks tell where a vertex belongs, 1 where nothing does
  std::vector<std::int32_t> missing;  ///< the vertices of what the target lacks or the scan does not show
  VertexScalars sliding;              ///< n, of mean 1: where vertices can slide [shares_of_sliding]
};

/// How far each vertex of a fit may lie from where it belongs, as root mean square [mm]. Five things add up as
/// squares: a least doubt, how far the ways onto the boundary went apart, how much the shape had to be strained, how
/// few features tell where along the surface a vertex belongs, and for what is missing the way to what is there. Half
/// of what holds everywhere lies where vertices can slide; its mean square stays. The scale was set on bones with
/// experts' landmarks and on phantom kidneys (docs/correspondence.md).
VertexScalars fit_doubt_mm(const Mesh& mesh, const ReasonsForDoubt& reasons);

}  // namespace homolog
