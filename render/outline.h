#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/mesh/topology.h"

namespace homolog {

/// The place where a plane cuts an edge of a mesh: between its vertices `low` < `high`, at `share` of the way (0…1).
struct EdgeCrossing {
  std::int32_t low = 0, high = 0;
  double share = 0;
  Vec3 point = Vec3::Zero();
};

/// The part of a plane inside one face.
struct OutlineSegment {
  std::int32_t face = 0;
  EdgeCrossing from, to;
};

/// The exact intersection of a mesh with the plane through `on_plane` (mm) across `normal` (any length but 0), one
/// segment for each face that the plane parts. A vertex on the plane counts as lying on the side that `normal` points
/// to, so that every closed mesh gives closed outlines whatever touches the plane; neighbouring faces share their
/// crossing bit for bit.
std::vector<OutlineSegment> intersect_plane(const Topology& topology, const Points& points, const Vec3& on_plane,
                                            const Vec3& normal);

}  // namespace homolog
