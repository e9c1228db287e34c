#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace homolog {

/// The value below which `share` (0…1) of the values lie; 0 without any.
template <class T>
T quantile(std::vector<T> values, double share) {
  if (values.empty()) return T{0};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace homolog
