#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

namespace homolog {

/// How many threads loops in parallel use in the whole process, the one that asks for them included: what
/// `set_thread_limit` was given, or the machine's cores. No result depends on it.
int thread_limit();
void set_thread_limit(int threads);  ///< at least 1

/// Calls `work(0)` … `work(count - 1)`, several at the same time, and returns when all are done. Two calls must not
/// write to the same place. If calls throw (memory ran out), the first exception is passed on, and calls that have not
/// begun by then are left out.
///
/// Threads that are free help; the calling thread takes part and, where none is free, does it all. So loops may be
/// nested and several threads may ask at a time: there are never more helpers than the limit allows. A thread that
/// waits for others does nothing else meanwhile, so it may hold a lock.
void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work);

/// Cuts 0…count into contiguous ranges and calls `work(first, last)` for each, several at the same time. The ranges
/// depend on `count` and `grain` alone, so that sums within a range have the same bits whatever the number of threads.
/// All but the last are multiples of `grain` long.
template <class Index, class Work>
void in_parallel(Index count, const Work& work, Index grain = 1) {
  constexpr Index most_ranges = 64;  // more than cores, so that they finish together
  const Index grains = (count + grain - 1) / grain;
  const Index length = (grains + most_ranges - 1) / most_ranges * grain;
  if (count <= 0) return;
  for_each_in_parallel(static_cast<std::size_t>((count + length - 1) / length), [&](std::size_t k) {
    const Index first = static_cast<Index>(k) * length;
    work(first, std::min(count, first + length));
  });
}

}  // namespace homolog
