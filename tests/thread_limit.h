#pragma once

#include "core/base/processes/parallel.h"

namespace homolog {

/// Sets how many threads loops use, and what was set before again.
struct ThreadLimit {
  explicit ThreadLimit(int threads) { set_thread_limit(threads); }
  ~ThreadLimit() { set_thread_limit(before); }
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;
  int before = thread_limit();
};

}  // namespace homolog
