#pragma once

namespace homolog {

/// Whether two pointers point at equal values, or both at nothing.
bool same_values(const auto& a, const auto& b) {
  return a == b || (a && b && *a == *b);
}

}  // namespace homolog
