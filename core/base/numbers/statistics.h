#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace homolog {

/// The mean of `of` each value, summed in their order; 0 without any.
template <class Values, class Of = std::identity>
double mean_of(const Values& values, const Of& of = {}) {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& value : values) {
    sum += std::invoke(of, value);
    ++count;
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

/// The middle value; of an even number the upper of the two. There must be one.
template <class T = double>
T median_of(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The value below which `share` (0…1) of the values lie; 0 without any.
template <class T>
T quantile(std::vector<T> values, double share) {
  if (values.empty()) return T{0};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace homolog
