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

/// How much of the doubt of a fit lies at each vertex: the mean over the vertices is 1. It is the variance that is left
/// of a smooth displacement once the surface is met: every place may go astray alike beforehand, and afterwards only
/// as the surface lets it slide. At a tip, an edge or a saddle it cannot slide far; where the surface is level, or
/// along a shaft or a crest, it can. [Rasmussen and Williams 2006, Eq. 2.24, of a Gaussian process on bumps, seen along
/// the normals at samples of the surface.] All 1 where nothing can be computed, as on a flat mesh. One thread.
VertexScalars shares_of_sliding(const Mesh& mesh);

/// How little the features of a shape say of where along its surface a place belongs: 0 where they say it, 1 of a round
/// organ, where many ways of lying on a boundary match alike. It goes by the sphericity: the surface of a ball of the
/// shape's volume over its own [Wadell 1935]. The rims of an open mesh are closed for the volume only, so that it
/// counts as rounder.
double roundness(const Mesh& mesh);

}  // namespace homolog
