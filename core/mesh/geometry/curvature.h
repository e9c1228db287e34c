#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// Discrete Gaussian curvature of every vertex: angle deficit / (area of its faces / 3), 1/mm².
VertexScalars gaussian_curvature(const Mesh& mesh);

/// Discrete mean curvature of every vertex, 1/mm: edge length × angle between its two faces, a quarter of the sum over
/// the vertex's edges / (area of its faces / 3). Positive where the surface bulges outward (1/r on a ball), 0 at
/// boundaries.
VertexScalars mean_curvature(const Mesh& mesh);

}  // namespace homolog
