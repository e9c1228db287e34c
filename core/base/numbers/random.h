#pragma once

#include <cstdint>

namespace homolog {

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

}  // namespace homolog
