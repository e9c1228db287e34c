#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/numbers/geometry.h"

namespace homolog::phantom {

/// 64 well-spread bits from any 64 (finaliser of splitmix64). Integer arithmetic only: the same on every machine.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

/// 0…1 from the upper bits of a hash.
constexpr double unit_of(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Mean 0, deviation 1, never beyond ±3.5: the sum of four 16-bit uniform numbers. No logarithm or cosine, whose last
/// digit differs between C libraries.
constexpr double normal_of(std::uint64_t bits) {
  const auto sum = (bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48);
  return (static_cast<double>(sum) - 2 * 65535.0) * (1.7320508075688772 / 65536.0);
}

/// A sequence of numbers that depends on its seed alone (the standard library's distributions differ between
/// implementations).
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) : key_(mix_bits(seed)) {}
  constexpr double uniform() { return unit_of(next()); }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  constexpr double normal() { return normal_of(next()); }

 private:
  constexpr std::uint64_t next() { return mix_bits(key_ + count_++); }
  std::uint64_t key_;
  std::uint64_t count_ = 0;
};

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
