#pragma once

#include <concepts>
#include <cstddef>

namespace homolog {

/// A position as Eigen and meshes count it (signed), for a standard container. Must not be negative.
template <std::signed_integral Signed>
constexpr std::size_t index(Signed i) {
  return static_cast<std::size_t>(i);
}

}  // namespace homolog
