#pragma once

#include <algorithm>
#include <thread>
#include <vector>

namespace homolog {

/// Cuts 0…count into one contiguous range a core and calls `work(first, last)` for each, all at the same time; returns
/// when all have. `work` must not throw, and what two ranges write must not overlap.
template <class Index, class Work>
void in_parallel(Index count, const Work& work) {
  const auto cores = static_cast<Index>(std::max(1U, std::thread::hardware_concurrency()));
  const Index ranges = std::min(cores, count);
  std::vector<std::jthread> threads;
  for (Index k = 1; k < ranges; ++k)
    threads.emplace_back([&work, first = count * k / ranges, last = count * (k + 1) / ranges] { work(first, last); });
  if (ranges > 0) work(Index{0}, count / ranges);
}

}  // namespace homolog
