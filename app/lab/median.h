#pragma once

#include <chrono>
#include <utility>
#include <vector>

#include "core/base/numbers/statistics.h"

namespace homolog {

inline double milliseconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double, std::milli>(d).count();
}

/// Median time of `work(repetition)` in ms over enough repetitions to fill about `budget_ms`, at least 5.
template <class Work>
double median_ms(const Work& work, double budget_ms = 300) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  const auto start = Clock::now();
  while (times.size() < 5 || (milliseconds(Clock::now() - start) < budget_ms && times.size() < 2000)) {
    const auto before = Clock::now();
    work(static_cast<int>(times.size()));
    times.push_back(milliseconds(Clock::now() - before));
  }
  return median_of(std::move(times));
}

}  // namespace homolog
