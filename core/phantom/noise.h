#pragma once

#include <cstdint>

#include "core/base/numbers/geometry.h"
#include "core/base/numbers/random.h"

namespace homolog::phantom {

/// Smooth random field, about −1…1, deviation ≈ 0.3, with features of one unit of `p`.
inline double smooth_noise(const Vec3& p, std::uint64_t seed) {
  const Eigen::Vector3d cell = p.array().floor();
  const Eigen::Array3d t = p - cell;
  const Eigen::Array3d s = t * t * (3 - 2 * t);
  const auto corner = [&](int dx, int dy, int dz) {
    const auto lattice = [](double c, int d) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(c) + d); };
    const std::uint64_t key =
        lattice(cell.x(), dx) * 0x8da6b343U + lattice(cell.y(), dy) * 0xd8163841U + lattice(cell.z(), dz) * 0xcb1ab31fU;
    return 2 * unit_of(mix_bits(key ^ seed)) - 1;
  };
  const auto along_x = [&](int dy, int dz) { return corner(0, dy, dz) * (1 - s.x()) + corner(1, dy, dz) * s.x(); };
  const auto along_y = [&](int dz) { return along_x(0, dz) * (1 - s.y()) + along_x(1, dz) * s.y(); };
  return along_y(0) * (1 - s.z()) + along_y(1) * s.z();
}

}  // namespace homolog::phantom
