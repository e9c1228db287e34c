#pragma once

#include <optional>

#include "core/mesh/topology.h"

namespace homolog {

/// What lies on the inner side of a plane (outward · p ≤ offset_mm, LPS mm): triangles are cut along it, and the cut
/// stays open. Empty where nothing is left, or what is left is no manifold surface.
std::optional<Mesh> clipped(const Mesh& mesh, const Vec3& outward, double offset_mm);

}  // namespace homolog
