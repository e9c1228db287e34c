#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh/closed_mesh.h"
#include "core/mesh/topology.h"

namespace homolog {

/// Two of several meshes.
using MeshPair = std::array<std::size_t, 2>;

/// How far a mesh lies within another, at its vertices and the middles of its edges and faces: the largest depth in mm,
/// or, where they do not meet, minus the smallest distance of what lies within `near_mm`; −near_mm where nothing does.
double depth_mm(const Mesh& mesh, const Mesh& other, double near_mm);

/// The share of a mesh's vertices that lie within another, 0…1.
double share_within(const Mesh& mesh, const ClosedMesh& other);

/// Moves meshes apart where two of a pair lie within each other, smoothly, until they are `gap_mm` apart (0:
/// until they touch). Both go the same way; where only one of them `yields`, it goes all of it (0 or 1 a mesh; empty:
/// all are alike). No vertex moves that is not near such a place, and no step turns a face or brings two faces of a
/// mesh through each other: it is taken back there. Returns what is left of each pair: the largest depth beyond the
/// gap, in mm; 0 where there is none.
std::vector<double> keep_apart(std::vector<Mesh>& meshes, std::span<const MeshPair> pairs, double gap_mm = 0,
                               const std::vector<char>& yields = {});

/// Spreads movements of vertices to those around, less with every ring. `held`: above 0 where a vertex's movement is
/// given and stays. `by`: n×3, in mm. `rings`: how far, in edges.
void spread_movement(const Topology& topology, const VertexScalars& held, Points& by, int rings = 4);

}  // namespace homolog
