#pragma once

#include <cmath>

namespace homolog {

/// No coordinate and no length that a person or a file gives is larger, in mm: a larger one is a mistake, and what is
/// computed from it overflows.
inline constexpr double farthest_mm = 1e9;
inline constexpr const char* beyond_farthest = "lies beyond 1,000,000,000 mm";

/// Whether a length or a coordinate is a number that is not larger.
inline bool is_in_reach(double mm) {
  return std::abs(mm) <= farthest_mm;
}
/// Whether all values of an array are.
bool all_in_reach(const auto& array) {
  return (array.array().abs() <= farthest_mm).all();
}

}  // namespace homolog
