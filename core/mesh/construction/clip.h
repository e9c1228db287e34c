#pragma once

#include <optional>

#include "core/mesh/topology.h"

namespace homolog {

/// The part of a mesh that has values below 0; `values`: one a vertex, linear over triangles. Triangles are cut, and
/// the cut stays open. Empty where nothing is left, or what is left is no manifold surface.
std::optional<Mesh> clipped(const Mesh& mesh, const VertexScalars& values);

/// The part that lies on the inner side of a plane (outward · p ≤ offset_mm, LPS mm), the same.
std::optional<Mesh> clipped(const Mesh& mesh, const Vec3& outward, double offset_mm);

}  // namespace homolog
