#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace homolog {

/// Cuts 0…count into one contiguous range a core and calls `work(first, last)` for each, all at the same time; returns
/// when all have. What two ranges write must not overlap. The first exception of a range (memory ran out) is passed on.
template <class Index, class Work>
void in_parallel(Index count, const Work& work) {
  const Index ranges = std::min(static_cast<Index>(std::max(1U, std::thread::hardware_concurrency())), count);
  std::vector<std::exception_ptr> thrown(static_cast<std::size_t>(ranges));
  const auto run = [&](Index k) {
    try {
      work(count * k / ranges, count * (k + 1) / ranges);
    } catch (...) {
      thrown[static_cast<std::size_t>(k)] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (Index k = 1; k < ranges; ++k) threads.emplace_back(run, k);
    if (ranges > 0) run(Index{0});
  }
  for (const std::exception_ptr& exception : thrown)
    if (exception) std::rethrow_exception(exception);
}

}  // namespace homolog
