#pragma once

#include <span>
#include <vector>

#include "core/structures/template_set.h"

namespace homolog {

/// Vertices of two meshes that coincide: those of which each is the nearest of the other and no farther than
/// `within_mm`; of some equally far that of the smaller number. In the order of `a`. Points n×3, LPS mm.
std::vector<VertexPair> coinciding_vertices(const Points& a, const Points& b, double within_mm);

/// Brings vertices that structures share to one place, the mean of where they are; vertices around go along, less with
/// every ring. A vertex that three structures share comes to one place too. `meshes`: of some structures of the set,
/// by `names`, in the numbering of their templates.
void join_shared(const std::vector<SharedVertices>& shared, std::span<const std::string> names,
                 std::vector<Mesh>& meshes);

/// How far shared vertices may lie apart, mm: nobody has to bring them together.
inline constexpr double shared_place_mm = 1e-6;

/// Brings vertices that structures share to where some of the meshes have them, the `leaders` (their places among the
/// meshes): the first of them that has such a vertex, rounded to the grid of computed points [moved_points.h]. Those
/// that no leader has stay, and those that lie at one place already. Vertices around go along, the wider the farther
/// they go.
void follow_shared(const std::vector<SharedVertices>& shared, std::span<const std::string> names,
                   std::vector<Mesh>& meshes, std::span<const std::size_t> leaders);

}  // namespace homolog
