#pragma once

#include "core/mesh/topology.h"

namespace homolog {

/// Sphere of 10·4^level + 2 evenly spread vertices (level 4: 2,562; 6: 40,962), closed, outward oriented.
Mesh icosphere(int level, double radius_mm = 1, const Vec3& centre = Vec3::Zero());

}  // namespace homolog
