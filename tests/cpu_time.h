#pragma once

#include <ctime>

namespace homolog::test {

/// Seconds that processors have worked for this process in `work`, on all its threads: what a limit on time is checked
/// with, since it does not grow with what else the machine does.
template <class Work>
double cpu_seconds_of(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace homolog::test
