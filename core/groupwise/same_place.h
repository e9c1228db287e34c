#pragma once

#include <optional>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/mesh/topology.h"

namespace homolog {

/// How far a fitted mesh and its target lie from each other at each vertex (n, mm): the vertex from the target, or the
/// target's places nearest to it from the mesh. 0 where the scan does not show it.
VertexScalars off_target_mm(const Mesh& fitted, const Boundary& target);

/// A place of a template at which several fits are off.
struct SamePlace {
  std::vector<std::int32_t> vertices;  ///< one patch, in rising order
  std::size_t fits = 0;                ///< how many are off at half of it or more
};

/// The largest place at which at least a third of the fits with one template are off, and three at least: there the
/// template has another form than the organs. Off is farther than 1.5 % of the diagonal. None where the fits are fewer
/// than three, or each is off elsewhere. `topology`: the template's; `off_shares`: of each fit n values, off_target_mm
/// by the diagonal of its mesh.
std::optional<SamePlace> off_at_same_place(const Topology& topology, const std::vector<VertexScalars>& off_shares);

}  // namespace homolog
