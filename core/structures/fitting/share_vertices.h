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

}  // namespace homolog
